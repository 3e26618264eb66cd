// The rotation of the IMU on the car, from tf.
#pragma once

#include <geometry_msgs/Quaternion.h>

#include <optional>
#include <string>

#include "ros/localization/lidar_extrinsics.h"

namespace racecar_mcl {

/// Looked up once; constant afterwards. Many drivers publish an IMU without a transform.
class ImuRotation {
 public:
  explicit ImuRotation(const LidarExtrinsicsLookup& lookup) : lookup_(lookup) {}

  /// The rotation of `imu_frame` in the base frame. None while tf may still arrive, in the first 2
  /// s
  /// (`now`: s); the identity after that.
  std::optional<geometry_msgs::Quaternion> find(const std::string& imu_frame,
                                                const std::string& odometry_frame, double now);
  /// Whether the identity is used because tf has no rotation of this frame.
  bool isAssumed() const { return rotation_ && !is_from_tf_; }

 private:
  const LidarExtrinsicsLookup& lookup_;
  std::optional<double> first_;  ///< s, of the first call
  std::optional<geometry_msgs::Quaternion> rotation_;
  bool is_from_tf_ = false;
};

}  // namespace racecar_mcl
