// Drives along a wall by the lidar alone: proportional to the distance to it, derivative by the
// angle to it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/car.h"
#include "sim/lidar.h"

namespace racecar_mcl::sim {

enum class Side { kLeft, kRight };

struct WallFollowerParameters {
  Side side = Side::kLeft;
  double wall_distance = 0.9;             ///< m, from the car's centre line to the wall
  double speed = 3.0;                     ///< m/s, where the way is clear and straight
  double min_speed = 0.6;                 ///< m/s, in the tightest place
  double max_lateral_acceleration = 5.0;  ///< m/s^2, v^2 curvature
  double max_braking = 5.0;               ///< m/s^2, below what the car can
  double margin = 0.12;                   ///< m, kept from everything beside the car's own width
  CarParameters car;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

/// The control law is a PD on distance and angle,
///
///     curvature = s ((d - target) / L^2 + 2 angle / L),      s = +1 left, -1 right,
///
/// critically damped with the length L, which grows with the speed. d and angle belong to the
/// nearest point of the wall's side, seen from a little ahead of the car. Nearest points need no
/// fitted lines: the wall in front of an inner corner, the edge of an outer one, a pillar and the
/// mouth of an alcove all count for what they are. Where both sides are near, the target is the
/// middle.
///
/// The same law, driven ahead on the sweep's points, foretells the path. Its curvature, its end and
/// what stands in its way set the speed, so that the car brakes before a curve and not in it.
class WallFollower {
 public:
  /// Throws ParameterError.
  explicit WallFollower(const WallFollowerParameters& parameters);

  /// Throws ParameterError and changes nothing.
  void setParameters(const WallFollowerParameters& parameters);
  const WallFollowerParameters& parameters() const { return parameters_; }

  /// What to do after a sweep, driving at `speed` m/s.
  Command follow(const LidarScan& sweep, double speed) const;

 private:
  WallFollowerParameters parameters_;
};

}  // namespace racecar_mcl::sim
