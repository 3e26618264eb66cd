#include "sim/driver.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "racecar_mcl/map/map_io.h"
#include "sim/simulator.h"
#include "support/ascii_map.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kPeriod = 0.02;  // s, control period

/// A lane of 3 m around a block, in cells of 1 m.
std::shared_ptr<const World> loop() {
  return std::make_shared<const World>(asciiMap(R"(
      ############
      #..........#
      #..........#
      #..........#
      #...####...#
      #...####...#
      #..........#
      #..........#
      #..........#
      ############)"));
}

/// A simulated car with a driver.
struct Car {
  Car(std::shared_ptr<const World> world, const Pose2& start)
      : simulator(std::move(world), {}, start, 1), driver(WallFollowerParameters{}) {}

  void drive(double seconds) {
    const double end = simulator.time() + seconds;
    while (simulator.time() < end - kPeriod / 2.0) {
      const Pose2 before = simulator.truth().base_in_map;
      command = driver.drive(simulator.look(), simulator.truth().twist.vx, simulator.collided());
      simulator.advance(kPeriod, command);
      driven += distance(before, simulator.truth().base_in_map);
    }
  }

  Simulator simulator;
  Driver driver;
  Command command;
  double driven = 0.0;  ///< m
};

TEST(Driver, IsTheWallFollowerWhereNothingIsMet) {
  const std::string map = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
  const auto world = std::make_shared<const World>(loadMap(worldPathFor(map)));
  Pose2 start;
  ASSERT_TRUE(loadStartPose(map, start));
  Simulator simulator(world, {}, start, 1);
  const WallFollower follower(WallFollowerParameters{});
  Car car(world, start);
  while (simulator.time() < 5.0) {
    simulator.advance(kPeriod, follower.follow(simulator.look(), simulator.truth().twist.vx));
    car.drive(kPeriod);
    ASSERT_EQ(simulator.truth().base_in_map.x, car.simulator.truth().base_in_map.x);
    ASSERT_EQ(simulator.truth().base_in_map.yaw, car.simulator.truth().base_in_map.yaw);
  }
}

TEST(Driver, DrivesOnFromWhereItFacesAWall) {
  // 3 cm in front of a wall, perpendicular and oblique, in the middle and in a corner.
  for (const double x : {5.5, 10.7}) {
    for (const double yaw : {-0.5, -0.2, 0.0, 0.2, 0.5}) {
      const double reach = 0.42 * std::cos(yaw) + 0.14 * std::sin(std::abs(yaw)) + 0.03;
      Car car(loop(), {x, 9.0 - reach, kPi / 2.0 + yaw});
      car.drive(15.0);
      EXPECT_GT(car.driven, 15.0) << x << ", " << yaw;
    }
  }
}

TEST(Driver, TurnsInADeadEndThatIsNarrowerThanItsTurningCircle) {
  const auto world = std::make_shared<const World>(asciiMap(R"(
      ##########################
      #............#############
      #............#############
      #............#############
      #............#############
      #........................#
      #........................#
      #........................#
      #............#############
      ##########################)",
                                                            0.4));
  Car car(world, {9.5, 1.4, 0.0});
  car.drive(25.0);
  EXPECT_LT(car.simulator.truth().base_in_map.x, 5.2);
}

TEST(Driver, WaitsASecondThenBacksOffFromTheRoomierSideAndTurnsToIt) {
  for (const double side : {1.0, -1.0}) {
    // A wall 0.5 m ahead and a wall on one side only.
    LidarScan sweep;
    sweep.angle_min = -0.75 * kPi;
    sweep.angle_increment = 1.5 * kPi / 540.0;
    for (int i = 0; i < 541; ++i) {
      const double bearing = sweep.angle_min + i * sweep.angle_increment;
      sweep.ranges.push_back(side * bearing > 0.5 ? HUGE_VALF : 0.5F);
    }
    Driver driver(WallFollowerParameters{});
    const WallFollower follower(WallFollowerParameters{});
    const auto at = [&](double stamp, double speed, bool collided) {
      sweep.stamp = stamp;
      return driver.drive(sweep, speed, collided);
    };
    const Command following = follower.follow(sweep, 0.0);
    for (int i = 0; i <= 50; ++i) {
      const Command command = at(5.0 + i * kPeriod, 0.0, true);
      EXPECT_EQ(command.speed, following.speed);
      EXPECT_EQ(command.steering, following.steering);
    }
    const Command back = at(6.02, 0.0, true);
    EXPECT_LT(back.speed, 0.0);
    EXPECT_LT(side * back.steering, -0.3);
    EXPECT_LT(at(6.9, -0.6, false).speed, 0.0);
    const Command ahead = at(7.04, -0.6, false);
    EXPECT_GT(ahead.speed, 0.0);
    EXPECT_GT(side * ahead.steering, 0.3);
    const Command again = at(8.0, 0.0, false);
    EXPECT_EQ(again.steering, following.steering);
  }
}

TEST(Driver, ACarThatCannotGoBackTurnsAwayAtOnce) {
  LidarScan sweep;
  sweep.angle_min = -1.0;
  sweep.angle_increment = 0.01;
  sweep.ranges.assign(201, 0.5F);
  Driver driver(WallFollowerParameters{});
  for (int i = 0; i <= 60; ++i) {
    sweep.stamp = i * kPeriod;
    driver.drive(sweep, 0.0, true);
  }
  sweep.stamp = 1.5;  // half a second of backing off
  EXPECT_GT(driver.drive(sweep, 0.0, true).speed, 0.0);
}

}  // namespace
}  // namespace racecar_mcl::sim
