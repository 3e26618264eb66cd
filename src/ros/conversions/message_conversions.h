// Conversions between messages and the core's types. The treatment of NaN, infinities (REP-117) and
// upside-down lidars is defined here and nowhere else.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>

#include <stdexcept>
#include <string>

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/motion/odometry_buffer.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// An invalid message; names the field, its value and the expected range.
struct MessageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// tf2 does not accept leading slashes; some drivers still send them.
std::string stripLeadingSlash(const std::string& frame);

/// The yaw of a quaternion, normalised first. Throws MessageError if it is zero or not finite.
double yawOf(const geometry_msgs::Quaternion& quaternion);
geometry_msgs::Quaternion quaternionOf(double yaw);

/// The planar part of a pose. Throws MessageError if it is not finite, over 1e7 m from the origin,
/// or its quaternion is zero.
Pose2 toPose2(const geometry_msgs::Pose& pose);
geometry_msgs::Pose toMessage(const Pose2& pose);
geometry_msgs::Transform toTransform(const Pose2& pose);

/// Uses the x, y and yaw elements of the 6 x 6 covariance. Throws as toPose2, and if one of these
/// is not finite.
PoseEstimate toPoseEstimate(const geometry_msgs::PoseWithCovariance& pose);
geometry_msgs::PoseWithCovariance toMessage(const PoseEstimate& estimate);

/// NaN and infinities are kept: the localizer rejects and counts them. An invalid pose becomes NaN.
OdometrySample toOdometrySample(const nav_msgs::Odometry& message);

/// The rate of turn about the z axis of a frame in which the IMU has the rotation `imu_in_base`.
/// NaN and infinities are kept. Throws MessageError if the IMU does not measure it
/// (angular_velocity_covariance[0] is -1) or the rotation is invalid.
GyroSample toGyroSample(const sensor_msgs::Imu& message,
                        const geometry_msgs::Quaternion& imu_in_base);

/// Pose of the lidar on the car.
struct LidarExtrinsics {
  Pose2 laser_in_base;
  bool upside_down = false;  ///< bearings are then clockwise
};

/// Throws MessageError if the pose is not finite or over 100 m from base_link.
void requireOnCar(const Pose2& laser_in_base);

/// From the transform `base_link` <- lidar frame. Throws as requireOnCar, and MessageError if the
/// lidar is tilted by more than 0.2 rad.
LidarExtrinsics toLidarExtrinsics(const geometry_msgs::Transform& laser_in_base);

/// Keeps beams with a range in [range_min, range_max) and +inf (no return, REP-117). Finite ranges
/// from range_max on become +inf, as older drivers report missing returns and as in amcl. NaN, -inf
/// and ranges below range_min are dropped. Bearings are counterclockwise as seen from above, in
/// (-pi, pi]. Throws MessageError on an empty scan, an invalid angle_min or angle_increment, or a
/// time_increment that is negative or not finite. Without `deskew` the time_increment is not read
/// and all beams have the time 0.
Scan toScan(const sensor_msgs::LaserScan& message, const LidarExtrinsics& extrinsics,
            bool deskew = true);

/// A pose in `frame` and a twist in `child_frame`; covariances are zero. Stamps are limited to
/// those of ros::Time, here and below.
nav_msgs::Odometry toOdometryMessage(double stamp, const Pose2& pose, const Twist2& twist,
                                     const std::string& frame, const std::string& child_frame);

geometry_msgs::TransformStamped toTransformMessage(double stamp, const Pose2& child_in_frame,
                                                   const std::string& frame,
                                                   const std::string& child_frame);

}  // namespace racecar_mcl
