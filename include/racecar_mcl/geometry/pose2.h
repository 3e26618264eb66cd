// Planar poses and angles. Metres and radians; x forward, y left, yaw counter-clockwise (REP-103).
#pragma once

#include <cmath>

#include "racecar_mcl/common/limits.h"

namespace racecar_mcl {

constexpr double kPi = 3.14159265358979323846;

/// The angle wrapped into (-pi, pi].
inline double wrapAngle(double angle) {
  // Most angles already are; std::remainder costs as much as a sine.
  if (angle > -kPi && angle <= kPi) return angle;
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// A frame's pose in another frame. A variable `base_in_map` holds the pose of `base` in `map`.
struct Pose2 {
  double x = 0.0;    ///< m
  double y = 0.0;    ///< m
  double yaw = 0.0;  ///< rad
};

/// A velocity in the body frame, as in nav_msgs/Odometry.
struct Twist2 {
  double vx = 0.0;  ///< m/s, forward
  double vy = 0.0;  ///< m/s, left
  double wz = 0.0;  ///< rad/s, counter-clockwise
};

inline bool isFinite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

inline bool isFinite(const Twist2& twist) {
  return std::isfinite(twist.vx) && std::isfinite(twist.vy) && std::isfinite(twist.wz);
}

/// Whether the pose is finite, and x and y are at most `max_coordinate` from 0.
inline bool isWithin(const Pose2& pose, double max_coordinate) {
  return isFinite(pose) && isWithin(pose.x, max_coordinate) && isWithin(pose.y, max_coordinate);
}

/// `b_in_a` followed by `c_in_b` is `c_in_a`.
inline Pose2 compose(const Pose2& b_in_a, const Pose2& c_in_b) {
  const double c = std::cos(b_in_a.yaw);
  const double s = std::sin(b_in_a.yaw);
  return {b_in_a.x + c * c_in_b.x - s * c_in_b.y, b_in_a.y + s * c_in_b.x + c * c_in_b.y,
          wrapAngle(b_in_a.yaw + c_in_b.yaw)};
}

/// `a_in_b`, the inverse of `b_in_a`.
inline Pose2 inverse(const Pose2& b_in_a) {
  const double c = std::cos(b_in_a.yaw);
  const double s = std::sin(b_in_a.yaw);
  return {-c * b_in_a.x - s * b_in_a.y, s * b_in_a.x - c * b_in_a.y, wrapAngle(-b_in_a.yaw)};
}

/// `c_in_b`, from two poses in the same frame `a`.
inline Pose2 between(const Pose2& b_in_a, const Pose2& c_in_a) {
  return compose(inverse(b_in_a), c_in_a);
}

/// The pose after moving with a constant twist: an arc, not a chord.
Pose2 integrate(const Twist2& twist, double seconds);

/// Linear interpolation: `from` at ratio 0, `to` at ratio 1; yaw along the shorter arc.
Pose2 interpolate(const Pose2& from, const Pose2& to, double ratio);

/// Straight-line distance between two positions, m.
inline double distance(const Pose2& a, const Pose2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace racecar_mcl
