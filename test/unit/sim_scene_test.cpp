#include <gtest/gtest.h>

#include "racecar_mcl/errors.h"
#include "sim/scene.h"

namespace racecar_mcl::sim {
namespace {

SceneParameters corridor() {
  SceneParameters parameters;
  parameters.map = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
  return parameters;
}

TEST(Scene, IsTheFineWorldFromTheMapsOwnStart) {
  const Scene scene = loadScene(corridor());
  EXPECT_EQ(scene.world_path, RACECAR_MCL_SOURCE_DIR "/maps/corridor_world.yaml");
  EXPECT_NEAR(scene.world->geometry().resolution, 0.01, 1e-12);
  EXPECT_LT(distance(scene.start_in_map, {-7.8, -2.65, 0.0}), 1e-9);
  EXPECT_TRUE(scene.obstacles.empty());
}

TEST(Scene, IsWhatWasAskedFor) {
  SceneParameters parameters = corridor();
  parameters.world = parameters.map;
  parameters.start = Pose2{-5.0, -2.65, 1.0};
  parameters.obstacles = 4;
  parameters.moving_obstacles = 1;
  const Scene scene = loadScene(parameters);
  EXPECT_EQ(scene.world_path, parameters.map);
  EXPECT_EQ(scene.start_in_map.yaw, 1.0);
  ASSERT_EQ(scene.obstacles.size(), 4U);
  int walking = 0;
  for (const Obstacle& obstacle : scene.obstacles) walking += obstacle.speed > 0.0;
  EXPECT_EQ(walking, 1);
}

TEST(Scene, StartsSomewhereFreeOnAMapWithoutAStart) {
  SceneParameters parameters = corridor();
  parameters.map = RACECAR_MCL_SOURCE_DIR "/maps/track_world.yaml";  // a map like any other
  const Scene scene = loadScene(parameters);
  EXPECT_EQ(scene.world_path, parameters.map);
  EXPECT_FALSE(overlaps(scene.start_in_map, parameters.car, *scene.world, {}, 0.0));
  parameters.seed = 2;
  EXPECT_GT(distance(loadScene(parameters).start_in_map, scene.start_in_map), 0.1);
}

TEST(Scene, DrawsObstaclesClearOfTheCar) {
  const SceneParameters parameters = [] {
    SceneParameters p = corridor();
    p.obstacles = 10;
    return p;
  }();
  const Scene scene = loadScene(corridor());
  const Pose2 car{2.0, -2.65, 0.0};
  const std::vector<Obstacle> obstacles = drawObstacles(parameters, *scene.world, car);
  ASSERT_EQ(obstacles.size(), 10U);
  for (const Obstacle& obstacle : obstacles) EXPECT_GT(distance(obstacle.in_map, car), 3.0);
}

TEST(Scene, RefusesWhatCannotBe) {
  EXPECT_THROW(loadScene(SceneParameters{}), ParameterError);
  SceneParameters parameters = corridor();
  parameters.start = Pose2{-7.8, -4.3, 0.0};  // in a wall
  EXPECT_THROW(loadScene(parameters), ParameterError);
  parameters = corridor();
  parameters.moving_obstacles = 1;  // of none
  EXPECT_THROW(loadScene(parameters), ParameterError);
  parameters = corridor();
  parameters.obstacles = 100000;
  EXPECT_THROW(loadScene(parameters), MapError);
  parameters = corridor();
  parameters.world = "/nowhere.yaml";
  EXPECT_THROW(loadScene(parameters), MapError);
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
