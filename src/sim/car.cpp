#include "sim/car.h"

#include <algorithm>
#include <array>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {

void CarParameters::validate() const {
  requirePositive("wheelbase", wheelbase, "m");
  require(max_steering > 0.0 && max_steering < kPi / 2.0, "max_steering", max_steering,
          "between 0 and pi/2", "rad");
  requirePositive("max_steering_rate", max_steering_rate, "rad/s");
  requireWithin("steering_delay", steering_delay, 0.0, 1.0);
  requirePositive("max_acceleration", max_acceleration, "m/s^2");
  requirePositive("max_deceleration", max_deceleration, "m/s^2");
  requirePositive("length_ahead", length_ahead, "m");
  requireNotNegative("length_behind", length_behind, "m");
  requirePositive("width", width, "m");
}

Twist2 twistOf(const CarState& car, const CarParameters& parameters) {
  return {car.speed, 0.0, car.speed * std::tan(car.steering) / parameters.wheelbase};
}

CarState followCommand(const CarState& car, const Command& command, const CarParameters& parameters,
                       double seconds) {
  const auto approach = [](double from, double to, double reach) {
    return from + std::clamp(to - from, -reach, reach);
  };
  const bool is_braking =
      car.speed * command.speed < 0.0 || std::abs(command.speed) < std::abs(car.speed);
  const double acceleration =
      is_braking ? parameters.max_deceleration : parameters.max_acceleration;
  const double steering =
      std::clamp(command.steering, -parameters.max_steering, parameters.max_steering);
  CarState next = car;
  next.speed = approach(car.speed, command.speed, acceleration * seconds);
  next.steering = approach(car.steering, steering, parameters.max_steering_rate * seconds);
  return next;
}

bool touches(const Pose2& base_in_map, const CarParameters& parameters, const World& world,
             const std::vector<Obstacle>& obstacles, double time, double clearance) {
  const double front = parameters.length_ahead + clearance;
  const double rear = -parameters.length_behind - clearance;
  const double side = parameters.width / 2.0 + clearance;
  struct Edge {
    Pose2 start_in_base;
    double length;
  };
  const std::array<Edge, 4> outline{{{{rear, -side, 0.0}, front - rear},
                                     {{front, -side, kPi / 2.0}, 2.0 * side},
                                     {{front, side, kPi}, front - rear},
                                     {{rear, side, -kPi / 2.0}, 2.0 * side}}};
  for (const Edge& edge : outline) {
    const Pose2 start = compose(base_in_map, edge.start_in_base);
    const Hit hit = world.cast({start.x, start.y}, start.yaw, edge.length, obstacles, time,
                               Ends::kWhereNotFree);
    if (std::isfinite(hit.range)) return true;
  }
  return false;
}

bool overlaps(const Pose2& base_in_map, const CarParameters& parameters, const World& world,
              const std::vector<Obstacle>& obstacles, double time, double clearance) {
  // Nested outlines, closer than a map cell.
  constexpr double kOutlineSpacing = 0.04;  // m
  for (double inset = 0.0; inset < parameters.width / 2.0 + clearance; inset += kOutlineSpacing) {
    if (touches(base_in_map, parameters, world, obstacles, time, clearance - inset)) return true;
  }
  return false;
}

}  // namespace racecar_mcl::sim
