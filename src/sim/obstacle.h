// Things in the world that no map knows: boxes and discs, standing or walking about.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/pose.h"

namespace racecar_mcl::sim {

/// A disc (a person, a column) or a box (a crate, another car).
struct Obstacle {
  enum class Shape { kDisc, kBox };

  Shape shape = Shape::kDisc;
  double radius = 0.15;  ///< m, of a disc
  double length = 0.40;  ///< m, of a box along its x axis
  double width = 0.40;   ///< m, of a box along its y axis
  Pose2 in_map;          ///< where it stands, while `path` is empty

  /// Points of the map walked from first to last and back again, without end, at `speed` from
  /// `path.front()` on; a box looks where it goes. One point is a place to stand.
  std::vector<Eigen::Vector2d> path;
  double speed = 0.0;       ///< m/s
  double start_time = 0.0;  ///< s, when it sets off from `path.front()`

  bool keeps_clear = false;  ///< of the car, by itself: whoever drives that does not look at it

  /// Throws ParameterError, naming the field, on a size that is not positive or a number that is
  /// not finite.
  void validate() const;
};

/// Where an obstacle is at `time` (s).
Pose2 poseAt(const Obstacle& obstacle, double time);

/// Distance from `origin` in the unit `direction` to the obstacle standing at `obstacle_in_map`: 0
/// from inside it, +infinity where the ray misses it.
double castObstacle(const Obstacle& obstacle, const Pose2& obstacle_in_map,
                    const Eigen::Vector2d& origin, const Eigen::Vector2d& direction);

}  // namespace racecar_mcl::sim
