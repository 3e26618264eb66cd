#include "ros/localization/imu_rotation.h"

#include <cmath>

namespace racecar_mcl {
namespace {

constexpr double kMaxWait = 2.0;  // s, for tf

}  // namespace

std::optional<geometry_msgs::Quaternion> ImuRotation::find(const std::string& imu_frame,
                                                           const std::string& odometry_frame,
                                                           double now) {
  if (rotation_) return rotation_;
  try {
    rotation_ = lookup_.transform(imu_frame, odometry_frame).rotation;
    is_from_tf_ = true;
    return rotation_;
  } catch (const MessageError&) {
    if (!first_) first_ = now;
    if (std::abs(now - *first_) < kMaxWait) return std::nullopt;
    rotation_ = quaternionOf(0.0);
    return rotation_;
  }
}

}  // namespace racecar_mcl
