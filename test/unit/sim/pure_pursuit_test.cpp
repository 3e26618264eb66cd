#include "sim/pure_pursuit.h"

#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "sim/simulator.h"
#include "support/ring_map.h"

namespace racecar_mcl::sim {
namespace {

Raceline ring() {
  SpeedLimits limits;
  limits.max_speed = 3.0;
  return {circle(4.0, 250), limits};
}

TEST(PurePursuit, SteersAlongACircle) {
  const PurePursuit driver(ring(), {});
  const Command command = driver.drive({4.0, 0.0, kPi / 2.0});
  EXPECT_NEAR(command.steering, std::atan(CarParameters().wheelbase / 4.0), 0.002);
  EXPECT_NEAR(command.speed, 3.0, 1e-9);
}

TEST(PurePursuit, SteersTowardsTheRaceline) {
  const PurePursuit driver(ring(), {});
  const double along = driver.drive({4.0, 0.0, kPi / 2.0}).steering;
  EXPECT_GT(driver.drive({4.3, 0.0, kPi / 2.0}).steering, along + 0.1);
  EXPECT_LT(driver.drive({3.7, 0.0, kPi / 2.0}).steering, along - 0.1);
}

TEST(PurePursuit, KeepsToTheSteeringLimit) {
  const PurePursuit driver(ring(), {});
  EXPECT_EQ(driver.drive({5.0, 0.0, -kPi / 2.0}).steering, -CarParameters().max_steering);
}

TEST(PurePursuit, ReturnsToTheRaceline) {
  const PurePursuit driver(ring(), {});
  SimulatorParameters parameters;
  parameters.lidar.beams = 2;
  Simulator car(std::make_shared<const World>(ringMap(3.0, 5.0)), parameters, {4.4, 0.0, kPi / 2.0},
                1);
  for (int i = 0; i < 250; ++i) car.advance(0.02, driver.drive(car.truth().base_in_map));
  const Pose2 end = car.truth().base_in_map;
  EXPECT_LT(std::abs(driver.raceline().placeOf({end.x, end.y}).lateral), 0.01);
  EXPECT_NEAR(car.truth().twist.vx, 3.0, 0.01);
  EXPECT_EQ(car.collisions(), 0);
}

TEST(PurePursuit, RefusesWrongParameters) {
  PurePursuitParameters parameters;
  parameters.min_look_ahead = 0.0;
  EXPECT_THROW(PurePursuit(ring(), parameters), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
