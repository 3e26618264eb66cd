// The car itself: a kinematic bicycle whose base_link lies on the rear axle.
#pragma once

#include "racecar_mcl/pose.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// A 1/10 racecar.
struct CarParameters {
  double wheelbase = 0.325;        ///< m, rear to front axle
  double max_steering = 0.34;      ///< rad, of the front wheels to either side
  double max_steering_rate = 3.2;  ///< rad/s
  double max_acceleration = 5.0;   ///< m/s^2
  double max_deceleration = 8.0;   ///< m/s^2
  double length_ahead = 0.42;      ///< m, base_link to the front bumper
  double length_behind = 0.10;     ///< m, base_link to the rear bumper
  double width = 0.28;             ///< m

  /// Throws ParameterError, naming the field.
  void validate() const;
};

/// What a driver asks for; the car follows within its limits.
struct Command {
  double speed = 0.0;     ///< m/s, negative = backwards
  double steering = 0.0;  ///< rad, positive = left
};

struct CarState {
  Pose2 base_in_map;
  double speed = 0.0;     ///< m/s, of the rear axle
  double steering = 0.0;  ///< rad
};

/// A stretch of motion with constant twist: an arc. It knows where the car is at every moment of
/// it.
struct Arc {
  double begin = 0.0;  ///< s
  double end = 0.0;    ///< s
  Pose2 base_in_map;   ///< at `begin`
  Twist2 twist;

  Pose2 at(double time) const { return compose(base_in_map, integrate(twist, time - begin)); }
};

/// wz = speed tan(steering) / wheelbase; the rear axle does not move sideways.
Twist2 twistOf(const CarState& car, const CarParameters& parameters);

/// Speed and steering brought towards the command as far as the limits allow within `seconds`; the
/// car stays.
CarState obey(const CarState& car, const Command& command, const CarParameters& parameters,
              double seconds);

/// Whether the car's outline, widened by `clearance` m all round, meets an obstacle or anything
/// that is not known to be free.
bool touches(const Pose2& base_in_map, const CarParameters& parameters, const World& world,
             const std::vector<Obstacle>& obstacles, double time, double clearance = 0.0);

/// The same, and also whether something lies wholly inside the outline: for a pose that was not
/// driven to.
bool overlaps(const Pose2& base_in_map, const CarParameters& parameters, const World& world,
              const std::vector<Obstacle>& obstacles, double time, double clearance = 0.0);

}  // namespace racecar_mcl::sim
