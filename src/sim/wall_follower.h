// Wall follower: PD control of the distance and angle to a wall, from lidar data.
#pragma once

#include <Eigen/Core>

#include "sim/car.h"
#include "sim/lidar.h"

namespace racecar_mcl::sim {

enum class Side { kLeft, kRight };

struct WallFollowerParameters {
  Side side = Side::kLeft;
  double wall_distance = 0.9;             ///< m, from the car's centre line to the wall
  double speed = 3.0;                     ///< m/s, on clear straights
  double min_speed = 0.6;                 ///< m/s, in narrow places
  double max_lateral_acceleration = 5.0;  ///< m/s^2, v^2 curvature
  double max_braking = 5.0;               ///< m/s^2, below the limit of the car
  double margin = 0.12;                   ///< m, clearance beside the car
  CarParameters car;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

/// The control law is a PD on distance and angle,
///
///     curvature = s ((d - target) / L^2 + 2 angle / L),      s = +1 left, -1 right,
///
/// critically damped with the length L, which increases with the speed. d and angle refer to the
/// nearest point on the wall's side, from a viewpoint ahead of the car. Nearest points, unlike
/// fitted lines, also handle corners, pillars and alcoves. If both sides are near, the target is
/// the middle.
///
/// Simulating the same law on the sweep's points predicts the path. Its curvature, its end and
/// obstacles on it limit the speed, so that the car brakes before a curve.
class WallFollower {
 public:
  /// Throws ParameterError.
  explicit WallFollower(const WallFollowerParameters& parameters);

  /// Throws ParameterError without changing anything.
  void setParameters(const WallFollowerParameters& parameters);
  const WallFollowerParameters& parameters() const { return parameters_; }

  /// The command after a sweep, at `speed` m/s.
  Command follow(const LidarScan& sweep, double speed) const;

 private:
  WallFollowerParameters parameters_;
};

}  // namespace racecar_mcl::sim
