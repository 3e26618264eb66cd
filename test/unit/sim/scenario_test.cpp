#include "sim/scenario.h"

#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl::sim {
namespace {

ScenarioParameters corridor() {
  ScenarioParameters parameters;
  parameters.map = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
  return parameters;
}

TEST(Scenario, IsTheFineWorldFromTheMapsOwnStart) {
  const Scenario scenario = loadScenario(corridor());
  EXPECT_EQ(scenario.world_path, RACECAR_MCL_SOURCE_DIR "/maps/corridor_world.yaml");
  EXPECT_NEAR(scenario.world->geometry().resolution, 0.01, 1e-12);
  EXPECT_LT(distance(scenario.start_in_map, {-7.8, -2.65, 0.0}), 1e-9);
  EXPECT_TRUE(scenario.obstacles.empty());
}

TEST(Scenario, IsWhatWasAskedFor) {
  ScenarioParameters parameters = corridor();
  parameters.world = parameters.map;
  parameters.start = Pose2{-5.0, -2.65, 1.0};
  parameters.obstacles = 4;
  parameters.moving_obstacles = 1;
  const Scenario scenario = loadScenario(parameters);
  EXPECT_EQ(scenario.world_path, parameters.map);
  EXPECT_EQ(scenario.start_in_map.yaw, 1.0);
  ASSERT_EQ(scenario.obstacles.size(), 4U);
  int walking = 0;
  for (const Obstacle& obstacle : scenario.obstacles) walking += obstacle.speed > 0.0;
  EXPECT_EQ(walking, 1);
}

TEST(Scenario, StartsSomewhereFreeOnAMapWithoutAStart) {
  ScenarioParameters parameters = corridor();
  parameters.map = RACECAR_MCL_SOURCE_DIR "/maps/track_world.yaml";  // a map like any other
  const Scenario scenario = loadScenario(parameters);
  EXPECT_EQ(scenario.world_path, parameters.map);
  EXPECT_FALSE(overlaps(scenario.start_in_map, parameters.car, *scenario.world, {}, 0.0));
  parameters.seed = 2;
  EXPECT_GT(distance(loadScenario(parameters).start_in_map, scenario.start_in_map), 0.1);
}

TEST(Scenario, DrawsObstaclesClearOfTheCar) {
  const ScenarioParameters parameters = [] {
    ScenarioParameters p = corridor();
    p.obstacles = 10;
    return p;
  }();
  const Scenario scenario = loadScenario(corridor());
  const Pose2 car{2.0, -2.65, 0.0};
  const std::vector<Obstacle> obstacles = drawObstacles(parameters, *scenario.world, car);
  ASSERT_EQ(obstacles.size(), 10U);
  for (const Obstacle& obstacle : obstacles) EXPECT_GT(distance(obstacle.in_map, car), 3.0);
}

TEST(Scenario, RefusesWhatCannotBe) {
  EXPECT_THROW(loadScenario(ScenarioParameters{}), ParameterError);
  ScenarioParameters parameters = corridor();
  parameters.start = Pose2{-7.8, -4.3, 0.0};  // in a wall
  EXPECT_THROW(loadScenario(parameters), ParameterError);
  parameters = corridor();
  parameters.moving_obstacles = 1;  // of none
  EXPECT_THROW(loadScenario(parameters), ParameterError);
  parameters = corridor();
  parameters.obstacles = 100000;
  EXPECT_THROW(loadScenario(parameters), MapError);
  parameters = corridor();
  parameters.world = "/nowhere.yaml";
  EXPECT_THROW(loadScenario(parameters), MapError);
}

TEST(Obstacle, SetsOffWhenItIsTold) {
  Obstacle walker;
  walker.path = {{1.0, 0.0}, {3.0, 0.0}};
  walker.speed = 0.5;
  walker.start_time = 1.7e9;
  EXPECT_NEAR(poseAt(walker, 1.0).x, 1.0, 1e-9);
  EXPECT_NEAR(poseAt(walker, 1.7e9).x, 1.0, 1e-9);
  EXPECT_NEAR(poseAt(walker, 1.7e9 + 2.0).x, 2.0, 1e-6);
  EXPECT_NEAR(poseAt(walker, 1.7e9 + 6.0).x, 2.0, 1e-6);
}

}  // namespace
}  // namespace racecar_mcl::sim
