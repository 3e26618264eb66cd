// A scenario, loaded from the files of a map: world, start pose and obstacles.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/car.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

struct ScenarioParameters {
  std::string map;             ///< map_server YAML
  std::string world;           ///< YAML of the finer world; empty = that of the map
  std::optional<Pose2> start;  ///< in the map frame; unset = that of the map, else random
  int obstacles = 0;           ///< number of unmapped obstacles
  int moving_obstacles = 0;    ///< number of them that move
  std::uint64_t seed = 1;      ///< of the placement; independent of sensor noise
  CarParameters car;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

struct Scenario {
  std::shared_ptr<const World> world;
  std::string world_path;
  Pose2 start_in_map;
  std::vector<Obstacle> obstacles;
};

/// Also reads the map, to report its errors before a localizer uses it. Throws ParameterError, also
/// if the start pose is not free, and MapError.
Scenario loadScenario(const ScenarioParameters& parameters);

/// New obstacles for a loaded scenario, clear of `keep_clear`.
std::vector<Obstacle> drawObstacles(const ScenarioParameters& parameters, const World& world,
                                    const Pose2& keep_clear);

}  // namespace racecar_mcl::sim
