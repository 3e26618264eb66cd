// A place to drive in, put together from a map's files: the walls, the start, and what stands
// about.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/car.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

struct SceneParameters {
  std::string map;             ///< map_server YAML
  std::string world;           ///< YAML of the finer world; empty = the one that belongs to the map
  std::optional<Pose2> start;  ///< in the map frame; unset = the map's own, else drawn at random
  int obstacles = 0;           ///< unmapped things beside the walls
  int moving_obstacles = 0;    ///< how many of them walk
  std::uint64_t seed = 1;      ///< of places; the sensors' noise is no part of it
  CarParameters car;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

struct Scene {
  std::shared_ptr<const World> world;
  std::string world_path;
  Pose2 start_in_map;
  std::vector<Obstacle> obstacles;
};

/// Reads the map as well, though only the world is kept: a broken map is to be told of before a
/// localizer meets it. Throws ParameterError, also where the start is not free, and MapError.
Scene loadScene(const SceneParameters& parameters);

/// Other obstacles for the same scene, `keep_clear` of them.
std::vector<Obstacle> drawObstacles(const SceneParameters& parameters, const World& world,
                                    const Pose2& keep_clear);

}  // namespace racecar_mcl::sim
