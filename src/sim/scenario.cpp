#include "sim/scenario.h"

#include <sstream>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/map/map_io.h"
#include "sim/random_placement.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kStartClearance = 0.3;  // m, around random start poses
constexpr std::uint64_t kPlacementSeed =
    0x706c616365ULL;  // decorrelates placement and sensor noise

Pose2 chooseStart(const ScenarioParameters& p, const std::string& world_path, const World& world,
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
            << "; expected a start \"x y yaw\" in free space";
    throw ParameterError(message.str());
  }
  return start;
}

}  // namespace

void ScenarioParameters::validate() const {
  if (map.empty()) throw ParameterError("map is not set; expected the path of a map_server YAML");
  require(obstacles >= 0, "obstacles", obstacles, "at least 0");
  require(moving_obstacles >= 0 && moving_obstacles <= obstacles, "moving_obstacles",
          moving_obstacles, "between 0 and the number of obstacles");
  car.validate();
}

Scenario loadScenario(const ScenarioParameters& parameters) {
  parameters.validate();
  loadMap(parameters.map);
  Scenario scenario;
  scenario.world_path = parameters.world.empty() ? worldPathFor(parameters.map) : parameters.world;
  scenario.world = std::make_shared<const World>(loadMap(scenario.world_path));
  Random random(parameters.seed ^ kPlacementSeed);
  scenario.start_in_map = chooseStart(parameters, scenario.world_path, *scenario.world, random);
  scenario.obstacles = scatterObstacles(*scenario.world, parameters.obstacles,
                                        parameters.moving_obstacles, scenario.start_in_map, random);
  return scenario;
}

std::vector<Obstacle> drawObstacles(const ScenarioParameters& parameters, const World& world,
                                    const Pose2& keep_clear) {
  Random random(parameters.seed ^ kPlacementSeed);
  return scatterObstacles(world, parameters.obstacles, parameters.moving_obstacles, keep_clear,
                          random);
}

}  // namespace racecar_mcl::sim
