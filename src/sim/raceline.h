// A closed raceline: path and speed profile.
#pragma once

#include <vector>

#include "sim/car.h"
#include "sim/racing_path.h"

namespace racecar_mcl::sim {

struct SpeedLimits {
  double max_speed = 7.6;  ///< m/s
  /// m/s^2; lateral and longitudinal acceleration together stay within this circle (friction
  /// coefficient times 9.81 m/s^2).
  double grip = 7.0;
  double max_acceleration = 5.0;  ///< m/s^2
  double max_deceleration = 8.0;  ///< m/s^2

  /// Throws ParameterError, naming the field.
  void validate() const;
};

class Raceline {
 public:
  /// Where a point is relative to the raceline.
  struct Place {
    double along = 0.0;    ///< m, of the nearest point from the first one
    double lateral = 0.0;  ///< m, positive to the left
  };

  /// `path` is closed, in the map frame. Throws ParameterError.
  Raceline(Path path, const SpeedLimits& limits);

  double length() const { return ends_.back(); }
  /// m/s, the highest and lowest of the profile.
  double maxSpeed() const;
  double minSpeed() const;

  /// The point and direction at `along` m from the first point; any number of laps.
  Pose2 poseAt(double along) const;
  /// m/s
  double speedAt(double along) const;
  Place placeOf(const Eigen::Vector2d& point_in_map) const;

 private:
  /// A segment and the fraction of it at `along`.
  struct Position {
    std::size_t segment;
    double fraction;
  };

  Position positionAt(double along) const;
  std::size_t after(std::size_t i) const { return (i + 1) % path_.size(); }
  double segmentLength(std::size_t i) const { return (path_[after(i)] - path_[i]).norm(); }

  Path path_;
  std::vector<double> ends_;    ///< m from the first point, of each segment's end
  std::vector<double> speeds_;  ///< m/s, at the points
};

}  // namespace racecar_mcl::sim
