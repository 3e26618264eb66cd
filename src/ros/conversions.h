// Messages to the core's types and back: free functions, no state. What a NaN, an infinity or an
// upside-down lidar means is decided here and nowhere else.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/Transform.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/LaserScan.h>

#include <stdexcept>
#include <string>

#include "racecar_mcl/odometry.h"
#include "racecar_mcl/pose_estimate.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

/// A message that cannot be used; says which field, its value and what was expected.
struct MessageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// tf2 takes no leading slash; ROS messages still carry them.
std::string stripLeadingSlash(const std::string& frame);

/// The yaw of a quaternion, which need not be of unit length. Throws MessageError where it is not
/// finite or zero.
double yawOf(const geometry_msgs::Quaternion& quaternion);
geometry_msgs::Quaternion quaternionOf(double yaw);

/// The planar part of a pose. Throws MessageError where it is not finite or its quaternion is zero.
Pose2 toPose2(const geometry_msgs::Pose& pose);
geometry_msgs::Pose toMessage(const Pose2& pose);
geometry_msgs::Transform toTransform(const Pose2& pose);

/// The cells for x, y and yaw of the 6 x 6 covariance; throws as toPose2, and where one of them is
/// not finite.
PoseEstimate toPoseEstimate(const geometry_msgs::PoseWithCovariance& pose);
geometry_msgs::PoseWithCovariance toMessage(const PoseEstimate& estimate);

/// NaN and inf are left for the localizer to refuse and count; a pose that cannot be read becomes
/// NaN.
OdometrySample toOdometrySample(const nav_msgs::Odometry& message);

/// How a lidar sits on the car.
struct LaserMount {
  Pose2 laser_in_base;
  bool upside_down = false;  ///< bearings then run clockwise
};

/// From the transform `base_link` <- lidar frame. Throws MessageError where it is not finite or the
/// lidar's plane is tilted by more than 0.2 rad.
LaserMount toLaserMount(const geometry_msgs::Transform& laser_in_base);

/// Keeps beams with a range in [range_min, range_max] and +inf (nothing within range, REP-117); a
/// finite range beyond range_max counts as +inf, as older drivers report no return. NaN, -inf and
/// ranges under range_min are dropped. Bearings are normalised to (-pi, pi] and seen from above.
/// Throws MessageError on an empty scan, an angle_increment or angle_min that cannot be, or a
/// time_increment that is negative or not finite.
Scan toScan(const sensor_msgs::LaserScan& message, const LaserMount& mount);

}  // namespace racecar_mcl
