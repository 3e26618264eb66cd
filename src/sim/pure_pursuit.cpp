#include "sim/pure_pursuit.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {

void PurePursuitParameters::validate() const {
  requirePositive("look_ahead_time", look_ahead_time, "s");
  requirePositive("min_look_ahead", min_look_ahead, "m");
  car.validate();
}

Command PurePursuit::drive(const Pose2& base_in_map) const {
  const double along = raceline_.placeOf({base_in_map.x, base_in_map.y}).along;
  const double speed = raceline_.speedAt(along);
  const double look_ahead =
      std::max(parameters_.min_look_ahead, parameters_.look_ahead_time * speed);
  const Pose2 target_in_base = between(base_in_map, raceline_.poseAt(along + look_ahead));
  const double squared = target_in_base.x * target_in_base.x + target_in_base.y * target_in_base.y;
  const double curvature = 2.0 * target_in_base.y / squared;
  const double steering = std::atan(curvature * parameters_.car.wheelbase);
  return {speed, std::clamp(steering, -parameters_.car.max_steering, parameters_.car.max_steering)};
}

}  // namespace racecar_mcl::sim
