#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

Pose2 integrate(const Twist2& twist, double seconds) {
  const double yaw = twist.wz * seconds;
  const double x = twist.vx * seconds;
  const double y = twist.vy * seconds;
  // sin(yaw)/yaw and (1 - cos(yaw))/yaw; by their Taylor series near 0, where the quotients lose
  // precision.
  const bool small = std::abs(yaw) < 1e-4;
  const double a = small ? 1.0 - yaw * yaw / 6.0 : std::sin(yaw) / yaw;
  const double b = small ? yaw / 2.0 : (1.0 - std::cos(yaw)) / yaw;
  return {a * x - b * y, b * x + a * y, wrapAngle(yaw)};
}

Pose2 interpolate(const Pose2& from, const Pose2& to, double ratio) {
  return {from.x + ratio * (to.x - from.x), from.y + ratio * (to.y - from.y),
          wrapAngle(from.yaw + ratio * wrapAngle(to.yaw - from.yaw))};
}

}  // namespace racecar_mcl
