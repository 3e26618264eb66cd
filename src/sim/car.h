// Kinematic bicycle model; base_link is on the rear axle.
#pragma once

#include "racecar_mcl/geometry/pose2.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// Defaults of a 1/10-scale racecar.
struct CarParameters {
  double wheelbase = 0.325;        ///< m, rear to front axle
  double max_steering = 0.34;      ///< rad, of the front wheels
  double max_steering_rate = 3.2;  ///< rad/s
  double steering_delay = 0.0;     ///< s, from a command to its beginning
  double max_acceleration = 5.0;   ///< m/s^2
  double max_deceleration = 8.0;   ///< m/s^2
  double length_ahead = 0.42;      ///< m, base_link to the front bumper
  double length_behind = 0.10;     ///< m, base_link to the rear bumper
  double width = 0.28;             ///< m

  /// Throws ParameterError, naming the field.
  void validate() const;
};

constexpr double kControlPeriod = 0.02;  // s, between the commands of a driver

/// Commanded speed and steering; the car follows within its limits.
struct Command {
  double speed = 0.0;     ///< m/s, negative = backwards
  double steering = 0.0;  ///< rad, positive = left
};

struct CarState {
  Pose2 base_in_map;
  double speed = 0.0;     ///< m/s, of the rear axle
  double steering = 0.0;  ///< rad
};

/// Motion with constant twist over an interval.
struct Arc {
  double begin = 0.0;  ///< s
  double end = 0.0;    ///< s
  Pose2 base_in_map;   ///< at `begin`
  Twist2 twist;

  Pose2 at(double time) const { return compose(base_in_map, integrate(twist, time - begin)); }
};

/// wz = speed tan(steering) / wheelbase; the rear axle does not move sideways.
Twist2 twistOf(const CarState& car, const CarParameters& parameters);

/// Speed and steering after `seconds` under the car's limits; the pose is unchanged.
CarState followCommand(const CarState& car, const Command& command, const CarParameters& parameters,
                       double seconds);

/// Whether the car's outline, expanded by `clearance` m, intersects an obstacle or space that is
/// not known to be free.
bool touches(const Pose2& base_in_map, const CarParameters& parameters, const World& world,
             const std::vector<Obstacle>& obstacles, double time, double clearance = 0.0);

/// As `touches`, but also detects obstacles entirely inside the outline: for poses that were not
/// reached by driving.
bool overlaps(const Pose2& base_in_map, const CarParameters& parameters, const World& world,
              const std::vector<Obstacle>& obstacles, double time, double clearance = 0.0);

}  // namespace racecar_mcl::sim
