#include "sim/traffic.h"

#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/map_io.h"
#include "sim/driver.h"
#include "sim/simulator.h"
#include "support/ascii_map.h"

namespace racecar_mcl::sim {
namespace {

std::shared_ptr<const World> corridor() {
  return std::make_shared<const World>(loadMap(RACECAR_MCL_SOURCE_DIR "/maps/corridor_world.yaml"));
}

const Pose2 kStart{-7.8, -2.65, 0.0};

TEST(Crowd, WalksInFreeSpaceClearOfWhereTheCarStarts) {
  const auto world = corridor();
  Random random(1);
  Crowd crowd(*world, kStart, random);
  const std::vector<Obstacle> first = crowd.walk(kStart, 100.0);
  EXPECT_GT(first.size(), 20U);
  std::vector<double> farthest(first.size(), 0.0);
  for (double time = 100.0; time < 130.0; time += 0.02) {
    const std::vector<Obstacle> now = crowd.walk(kStart, time);
    for (std::size_t i = 0; i < now.size(); ++i) {
      ASSERT_TRUE(world->isFree({now[i].in_map.x, now[i].in_map.y}));
      ASSERT_GT(distance(now[i].in_map, kStart), 1.5);
      farthest[i] = std::max(farthest[i], distance(now[i].in_map, first[i].in_map));
    }
  }
  for (const double way : farthest) EXPECT_GT(way, 0.7);
}

TEST(Crowd, WalksIntoNoCarThatStands) {
  const auto world = corridor();
  Random random(1);
  Crowd crowd(*world, kStart, random);
  const Pose2 car = compose(crowd.walk(kStart, 0.0).front().in_map, {0.8, 0.0, 0.0});
  const Pose2 centre = compose(car, {0.16, 0.0, 0.0});
  for (double time = 0.0; time < 30.0; time += 0.02) {
    const Obstacle walker = crowd.walk(car, time).front();
    ASSERT_GT(distance(walker.in_map, centre), 0.57);
  }
}

TEST(Crowd, LetsTheCarGetOn) {
  const auto world = corridor();
  Random random(1);
  Crowd crowd(*world, kStart, random);
  Simulator simulator(world, {}, kStart, 1, 100.0);
  Driver driver(WallFollowerParameters{});
  double driven = 0.0;
  while (simulator.time() < 130.0) {
    const Pose2 before = simulator.truth().base_in_map;
    simulator.setObstacles(crowd.walk(before, simulator.time()));
    simulator.advance(
        0.02, driver.drive(simulator.look(), simulator.truth().twist.vx, simulator.collided()));
    driven += distance(before, simulator.truth().base_in_map);
  }
  EXPECT_GT(driven, 30.0);
}

TEST(Crowd, NeedsRoom) {
  Random random(1);
  EXPECT_THROW(Crowd(World(asciiMap("#.#")), {}, random), MapError);
}

TEST(Opponent, StaysBesideOrAheadOfTheCarWithoutTouchingIt) {
  const auto world = corridor();
  for (const std::uint64_t seed : {1, 2}) {
    Simulator simulator(world, {}, kStart, 1, 100.0);
    Driver driver(WallFollowerParameters{});
    Opponent opponent(seed);
    double leftmost = 0.0, rightmost = 0.0;
    int in_wall = 0, looks = 0;
    while (simulator.time() < 130.0) {
      const Pose2 car = simulator.truth().base_in_map;
      const Obstacle other = opponent.follow(car, simulator.time(), *world);
      simulator.setObstacles({other});
      const Pose2 other_in_car = between(car, other.in_map);
      EXPECT_LT(std::hypot(other_in_car.x, other_in_car.y), 1.5);
      EXPECT_GT(other_in_car.x, -0.2);
      leftmost = std::max(leftmost, other_in_car.y);
      rightmost = std::min(rightmost, other_in_car.y);
      in_wall += world->isFree({other.in_map.x, other.in_map.y}) ? 0 : 1;
      ++looks;
      simulator.advance(
          0.02, driver.drive(simulator.look(), simulator.truth().twist.vx, simulator.collided()));
    }
    EXPECT_EQ(simulator.collisions(), 0);
    EXPECT_GT(leftmost, 0.5);
    EXPECT_LT(rightmost, -0.5);
    EXPECT_LT(in_wall, looks / 50);
  }
}

TEST(Opponent, IsSeenByTheLidarAndNotByTheDriver) {
  const auto world = std::make_shared<const World>(asciiMap("#.........#"));
  SimulatorParameters exact;
  exact.lidar.range_noise = 0.0;
  exact.lidar.missing_rate = 0.0;
  Simulator simulator(world, exact, {3.0, 0.5, 0.0}, 1);
  Obstacle ahead;
  ahead.in_map = {6.0, 0.5, 0.0};
  ahead.keeps_clear = true;
  simulator.setObstacles({ahead});
  EXPECT_NEAR(simulator.look().ranges[270], 6.73, 1e-6);
  for (const Event& event : simulator.advance(0.03, {})) {
    if (const auto* sweep = std::get_if<LidarScan>(&event.data)) {
      EXPECT_NEAR(sweep->ranges[540], 6.0 - 0.15 - 3.27, 1e-6);
    }
  }
}

}  // namespace
}  // namespace racecar_mcl::sim
