#include "sim/wall_follower.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/map_io.h"
#include "sim/lap_counter.h"
#include "sim/random_placement.h"
#include "sim/simulator.h"

namespace racecar_mcl::sim {
namespace {

const std::string kMaps = RACECAR_MCL_SOURCE_DIR "/maps/";

struct Outcome {
  int laps = 0;
  int collisions = 0;
  double top_speed = 0.0;
  double seconds = 0.0;
};

/// One lap of a map, or `limit` s.
Outcome driveALap(const std::string& map, Side side, double speed, int obstacles = 0,
                  double limit = 60.0) {
  const auto world = std::make_shared<const World>(loadMap(worldPathFor(kMaps + map + ".yaml")));
  Pose2 start;
  EXPECT_TRUE(loadStartPose(kMaps + map + ".yaml", start));
  SimulatorParameters parameters;
  parameters.lidar.beams = 541;  // half the beams of the real lidar, for speed
  Simulator simulator(world, parameters, start, 1);
  Random random(1);
  simulator.setObstacles(scatterObstacles(*world, obstacles, obstacles / 2, start, random));
  WallFollowerParameters follower_parameters;
  follower_parameters.side = side;
  follower_parameters.speed = speed;
  const WallFollower follower(follower_parameters);
  LapCounter laps(start);
  Command command;
  Outcome outcome;
  while (laps.laps() == 0 && simulator.time() < limit) {
    for (const Event& event : simulator.advance(0.005, command)) {
      if (const auto* sweep = std::get_if<LidarScan>(&event.data)) {
        command = follower.follow(*sweep, simulator.truth().twist.vx);
      }
    }
    laps.update(simulator.truth().base_in_map);
    outcome.top_speed = std::max(outcome.top_speed, simulator.truth().twist.vx);
  }
  outcome.laps = laps.laps();
  outcome.collisions = simulator.collisions();
  outcome.seconds = simulator.time();
  return outcome;
}

struct Course {
  const char* map;
  Side side;
  double speed;
};

class WallFollowerOn : public testing::TestWithParam<Course> {};

TEST_P(WallFollowerOn, DrivesALapWithoutACollision) {
  const Outcome outcome = driveALap(GetParam().map, GetParam().side, GetParam().speed);
  EXPECT_EQ(outcome.laps, 1);
  EXPECT_EQ(outcome.collisions, 0);
  EXPECT_GT(outcome.top_speed, 0.9 * GetParam().speed);
}

INSTANTIATE_TEST_SUITE_P(Courses, WallFollowerOn,
                         testing::Values(Course{"corridor", Side::kLeft, 3.0},
                                         Course{"corridor", Side::kRight, 3.0},
                                         Course{"track", Side::kLeft, 3.0},
                                         Course{"track", Side::kLeft, 7.0},
                                         Course{"track", Side::kRight, 7.0}));

TEST(WallFollower, PassesUnmappedThings) {
  const Outcome outcome = driveALap("corridor", Side::kLeft, 3.0, 8);
  EXPECT_EQ(outcome.laps, 1);
  EXPECT_EQ(outcome.collisions, 0);
}

/// A sweep next to a straight wall `distance` m to the left, with the car at `yaw` to the wall.
LidarScan sweepBesideAWall(double distance, double yaw) {
  LidarScan sweep;
  sweep.angle_min = -0.75 * kPi;
  sweep.angle_increment = 1.5 * kPi / 1080.0;
  for (int i = 0; i < 1081; ++i) {
    const double toward = std::sin(yaw + sweep.angle_min + i * sweep.angle_increment);
    const double range = toward > 0.0 ? distance / toward : 100.0;
    sweep.ranges.push_back(range < 10.0 ? static_cast<float>(range) : HUGE_VALF);
  }
  return sweep;
}

TEST(WallFollower, SteersByDistanceAndAngle) {
  const WallFollower follower(WallFollowerParameters{});
  EXPECT_NEAR(follower.follow(sweepBesideAWall(0.9, 0.0), 2.0).steering, 0.0, 0.02);
  EXPECT_GT(follower.follow(sweepBesideAWall(1.3, 0.0), 2.0).steering, 0.03);
  EXPECT_LT(follower.follow(sweepBesideAWall(0.6, 0.0), 2.0).steering, -0.03);
  EXPECT_LT(follower.follow(sweepBesideAWall(0.9, 0.2), 2.0).steering, -0.03);
  EXPECT_GT(follower.follow(sweepBesideAWall(0.9, -0.2), 2.0).steering, 0.03);
}

TEST(WallFollower, GoesStraightAndSlowlyWhereItSeesNothing) {
  LidarScan nothing = sweepBesideAWall(0.9, 0.0);
  nothing.ranges.assign(1081, HUGE_VALF);
  const Command command = WallFollower(WallFollowerParameters{}).follow(nothing, 1.0);
  EXPECT_EQ(command.steering, 0.0);
  EXPECT_GT(command.speed, 0.0);
}

TEST(WallFollower, RefusesWhatCannotBe) {
  WallFollowerParameters parameters;
  parameters.speed = 0.0;
  EXPECT_THROW(WallFollower{parameters}, ParameterError);
}

TEST(LapCounter, CountsCrossingsInTheStartsDirection) {
  LapCounter laps({0.0, 0.0, kPi / 2});
  const auto along = [&](double from, double to) {
    for (int i = 0; i <= 100; ++i) {
      const double angle = from + (to - from) * i / 100.0;
      laps.update({-6.0 + 6.0 * std::cos(angle), 6.0 * std::sin(angle), angle});
    }
  };
  along(0.0, 0.2);
  along(0.2, -0.1);  // crosses the line again without having left
  along(-0.1, 0.1);
  EXPECT_EQ(laps.laps(), 0);
  along(0.1, 2.1 * kPi);
  EXPECT_EQ(laps.laps(), 1);
  along(0.1, 2.1 * kPi);
  EXPECT_EQ(laps.laps(), 2);
}

}  // namespace
}  // namespace racecar_mcl::sim
