// Unmapped obstacles: static or moving boxes and discs.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl::sim {

/// A disc (such as a person) or a box (such as another car).
struct Obstacle {
  enum class Shape { kDisc, kBox };

  Shape shape = Shape::kDisc;
  double radius = 0.15;  ///< m, of a disc
  double length = 0.40;  ///< m, of a box along its x axis
  double width = 0.40;   ///< m, of a box along its y axis
  Pose2 in_map;          ///< pose while `path` is empty

  /// Map points between which the obstacle moves back and forth at `speed`, starting at
  /// `path.front()`; boxes face the direction of motion. A single point is a fixed position.
  std::vector<Eigen::Vector2d> path;
  double speed = 0.0;       ///< m/s
  double start_time = 0.0;  ///< s, departure from `path.front()`

  bool keeps_clear = false;  ///< avoids the car itself; ignored by the car's driver

  /// Throws ParameterError, naming the field, if a size is not positive or a number is not finite.
  void validate() const;
};

/// Pose at `time` (s).
Pose2 poseAt(const Obstacle& obstacle, double time);

/// Distance from `origin` along the unit vector `direction` to the obstacle at `obstacle_in_map`: 0
/// inside it, +infinity if the ray misses it.
double castObstacle(const Obstacle& obstacle, const Pose2& obstacle_in_map,
                    const Eigen::Vector2d& origin, const Eigen::Vector2d& direction);

}  // namespace racecar_mcl::sim
