#include "sim/scene.h"

#include <sstream>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/map_io.h"
#include "racecar_mcl/require.h"
#include "sim/placement.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kStartClearance = 0.3;  // m, round a start drawn at random
constexpr std::uint64_t kPlacesSeed =
    0x706c616365ULL;  // parts the places drawn from the sensors' noise

Pose2 chooseStart(const SceneParameters& p, const std::string& world_path, const World& world,
                  Random& random) {
  Pose2 start;
  if (p.start) {
    start = *p.start;
  } else if (!loadStartPose(p.map, start)) {
    return randomFreePose(world, p.car, random, kStartClearance);
  }
  if (!world.isFree({start.x, start.y}) || overlaps(start, p.car, world, {}, 0.0)) {
    std::ostringstream message;
    message << "the start pose (" << start.x << ", " << start.y << ", " << start.yaw
            << ") is not in the free space of " << world_path
            << "; expected a start \"x y yaw\" where the car touches nothing";
    throw ParameterError(message.str());
  }
  return start;
}

}  // namespace

void SceneParameters::validate() const {
  if (map.empty()) throw ParameterError("map is not set; expected the path of a map_server YAML");
  require(obstacles >= 0, "obstacles", obstacles, "at least 0");
  require(moving_obstacles >= 0 && moving_obstacles <= obstacles, "moving_obstacles",
          moving_obstacles, "between 0 and the number of obstacles");
  car.validate();
}

Scene loadScene(const SceneParameters& parameters) {
  parameters.validate();
  loadMap(parameters.map);
  Scene scene;
  scene.world_path = parameters.world.empty() ? worldPathFor(parameters.map) : parameters.world;
  scene.world = std::make_shared<const World>(loadMap(scene.world_path));
  Random random(parameters.seed ^ kPlacesSeed);
  scene.start_in_map = chooseStart(parameters, scene.world_path, *scene.world, random);
  scene.obstacles = scatterObstacles(*scene.world, parameters.obstacles,
                                     parameters.moving_obstacles, scene.start_in_map, random);
  return scene;
}

std::vector<Obstacle> drawObstacles(const SceneParameters& parameters, const World& world,
                                    const Pose2& keep_clear) {
  Random random(parameters.seed ^ kPlacesSeed);
  return scatterObstacles(world, parameters.obstacles, parameters.moving_obstacles, keep_clear,
                          random);
}

}  // namespace racecar_mcl::sim
