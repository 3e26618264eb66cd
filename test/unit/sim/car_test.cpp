#include "sim/car.h"

#include <gtest/gtest.h>

#include <memory>

#include "racecar_mcl/common/errors.h"
#include "sim/random_placement.h"
#include "sim/simulator.h"
#include "support/ascii_map.h"

namespace racecar_mcl::sim {
namespace {

/// 20 m x 20 m of free cells.
std::shared_ptr<const World> openGround() {
  return std::make_shared<const World>(
      OccupancyGrid({2, 2, 10.0, {-10.0, -10.0, 0.0}}, std::vector<std::int8_t>(4, 0)));
}

TEST(Car, DrivesTheCircleOfItsSteering) {
  SimulatorParameters parameters;
  parameters.car.max_acceleration = 1e6;
  parameters.car.max_steering_rate = 1e6;
  Simulator simulator(openGround(), parameters, {}, 1);
  const double steering = 0.2;
  const double radius = parameters.car.wheelbase / std::tan(steering);
  const double speed = 2.0;
  const double quarter = radius * kPi / 2.0 / speed;  // s for a quarter of the circle
  simulator.advance(quarter, {speed, steering});
  const Truth truth = simulator.truth();
  // Simulation steps are 1 ms: the arc ends at the last full step.
  const double angle = speed * truth.stamp / radius;
  EXPECT_NEAR(truth.base_in_map.x, radius * std::sin(angle), 1e-9);
  EXPECT_NEAR(truth.base_in_map.y, radius * (1.0 - std::cos(angle)), 1e-9);
  EXPECT_NEAR(truth.base_in_map.yaw, angle, 1e-9);
  EXPECT_NEAR(truth.twist.wz, speed / radius, 1e-12);
}

TEST(Car, KeepsItsLimits) {
  const CarParameters parameters;
  CarState car;
  car = followCommand(car, {10.0, 1.0}, parameters, 0.1);
  EXPECT_NEAR(car.speed, 0.5, 1e-12);
  EXPECT_NEAR(car.steering, 0.32, 1e-12);
  car = followCommand(car, {10.0, 1.0}, parameters, 10.0);
  EXPECT_NEAR(car.speed, 10.0, 1e-12);
  EXPECT_NEAR(car.steering, parameters.max_steering, 1e-12);
  car = followCommand(car, {0.0, 0.0}, parameters, 0.1);
  EXPECT_NEAR(car.speed, 9.2, 1e-12);
}

TEST(Car, StopsAtAWallAndBacksOff) {
  // Free from x = 1 to x = 9.
  const auto world = std::make_shared<const World>(asciiMap(R"(
      ##########
      #........#
      #........#
      ##########)"));
  Simulator simulator(world, {}, {4.0, 2.0, 0.0}, 1);
  simulator.advance(4.0, {3.0, 0.0});
  EXPECT_TRUE(simulator.collided());
  EXPECT_EQ(simulator.collisions(), 1);
  EXPECT_NEAR(simulator.truth().base_in_map.x, 9.0 - 0.42, 0.005);
  simulator.advance(1.0, {-1.0, 0.0});
  EXPECT_FALSE(simulator.collided());
  EXPECT_LT(simulator.truth().base_in_map.x, 8.0);
  EXPECT_EQ(simulator.collisions(), 1);
}

TEST(Car, StopsWhereItIsNotKnownToBeFree) {
  for (const char* map : {"..........", "?........?"}) {
    const auto world = std::make_shared<const World>(asciiMap(map));
    const double free_until = map[9] == '?' ? 9.0 : 10.0;
    Simulator simulator(world, {}, {4.0, 0.5, 0.0}, 1);
    simulator.advance(4.0, {3.0, 0.0});
    EXPECT_EQ(simulator.collisions(), 1);
    EXPECT_NEAR(simulator.truth().base_in_map.x, free_until - 0.42, 0.005);
    simulator.advance(20.0, {-3.0, 0.0});
    EXPECT_EQ(simulator.collisions(), 2);
    EXPECT_NEAR(simulator.truth().base_in_map.x, 10.0 - free_until + 0.10, 0.005);
  }
}

TEST(Car, GetsIntoNoWallWhileSomethingRunsIntoIt) {
  const auto world = std::make_shared<const World>(asciiMap("#........#"));
  Simulator simulator(world, {}, {8.0, 0.5, 0.0}, 1);
  Obstacle disc;
  disc.in_map = {8.0, 0.6, 0.0};
  simulator.setObstacles({disc});
  simulator.advance(2.0, {1.0, 0.0});
  EXPECT_NEAR(simulator.truth().base_in_map.x, 9.0 - 0.42, 0.005);
}

TEST(Car, IsTouchedByItsOutlineOnly) {
  const World world(asciiMap(R"(
      ....
      ....
      ...#)"));
  const CarParameters car;
  EXPECT_FALSE(touches({2.57, 0.5, 0.0}, car, world, {}, 0.0));
  EXPECT_TRUE(touches({2.59, 0.5, 0.0}, car, world, {}, 0.0));
  EXPECT_TRUE(touches({2.57, 0.5, 0.0}, car, world, {}, 0.0, 0.05));
  EXPECT_FALSE(touches({2.57, 0.5, kPi}, car, world, {}, 0.0));
  Obstacle disc;
  disc.radius = 0.1;
  disc.in_map = {1.0, 1.2, 0.0};
  EXPECT_TRUE(touches({1.0, 1.0, 0.0}, car, world, {disc}, 0.0));
  EXPECT_FALSE(touches({1.0, 0.9, 0.0}, car, world, {disc}, 0.0));
}

TEST(Car, OverlapsWhatLiesWhollyInsideItsOutline) {
  std::vector<std::int8_t> cells(41 * 41, OccupancyGrid::kFree);
  cells[20 * 41 + 20] = OccupancyGrid::kOccupied;
  const World world(OccupancyGrid({41, 41, 0.05, {-0.85, -1.025, 0.0}}, cells));
  const CarParameters car;
  EXPECT_FALSE(touches({0.0, 0.0, 0.0}, car, world, {}, 0.0));
  EXPECT_TRUE(overlaps({0.0, 0.0, 0.0}, car, world, {}, 0.0));
  EXPECT_FALSE(overlaps({0.5, 0.0, 0.0}, car, world, {}, 0.0));
}

TEST(Placement, FreePosesTouchNothing) {
  const World world(asciiMap(R"(
      ??????
      ?####?
      ?#..#?
      ?#..#?
      ?####?)"));
  const CarParameters car;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Pose2 pose = randomFreePose(world, car, random, 0.1);
    EXPECT_FALSE(overlaps(pose, car, world, {}, 0.0, 0.1));
    EXPECT_TRUE(pose.x > 2.0 && pose.x < 4.0 && pose.y > 1.0 && pose.y < 3.0);
  }
}

TEST(Placement, KeepsClearOfWhatIsUnknown) {
  const World world(asciiMap(R"(
      ??????
      ?....?
      ?.?..?
      ?....?)"));
  const CarParameters car;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Pose2 pose = randomFreePose(world, car, random, 0.1);
    EXPECT_TRUE(world.isFree({pose.x, pose.y}));
    EXPECT_FALSE(overlaps(pose, car, world, {}, 0.0, 0.1));
  }
  // Passages across unknown cells do not count: only the ends have room.
  const World narrow(asciiMap("#####\n.....\n?????"));
  for (int i = 0; i < 20; ++i) {
    const Obstacle obstacle = scatterObstacles(narrow, 1, 0, {-9.0, 0.0, 0.0}, random).at(0);
    EXPECT_GT(std::abs(obstacle.in_map.x - 2.5), 2.1);
  }
}

TEST(Placement, SaysWhenThereIsNoRoom) {
  const World no_room(asciiMap("#.#", 0.1));
  const World no_cell(asciiMap("###"));
  Random random(3);
  EXPECT_THROW(randomFreePose(no_room, {}, random), MapError);
  EXPECT_THROW(randomFreePose(no_cell, {}, random), MapError);
  EXPECT_THROW(scatterObstacles(no_room, 1, 0, {}, random), MapError);
}

}  // namespace
}  // namespace racecar_mcl::sim
