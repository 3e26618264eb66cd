#include "ros/conversions/message_conversions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace racecar_mcl {
namespace {

/// Clamped to the range of ros::Time, which throws beyond it.
ros::Time timeOf(double stamp) {
  return ros::Time(std::clamp(stamp, 0.0, ros::TIME_MAX.toSec() - 1.0));
}

constexpr double kMaxMountTilt = 0.2;  // rad

// Rows and columns of a ROS covariance: x, y, z, roll, pitch, yaw.
constexpr int kAxes[3] = {0, 1, 5};

struct Quaternion {
  double x, y, z, w;
};

Quaternion normalized(const geometry_msgs::Quaternion& q) {
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!std::isfinite(length) || length < 1e-6) {
    std::ostringstream problem;
    problem << "the quaternion (" << q.x << ", " << q.y << ", " << q.z << ", " << q.w
            << ") is not an orientation; expected a finite one of unit length";
    throw MessageError(problem.str());
  }
  return {q.x / length, q.y / length, q.z / length, q.w / length};
}

/// The z component of the body's z axis: 1 upright, -1 upside down.
double upwards(const Quaternion& q) { return 1.0 - 2.0 * (q.x * q.x + q.y * q.y); }

/// The heading of the body's x axis in the plane.
double heading(const Quaternion& q) {
  return std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z));
}

/// The reason why a scan is invalid; empty if it is valid.
std::string problemOf(const sensor_msgs::LaserScan& scan, bool deskew) {
  const auto beams = static_cast<double>(scan.ranges.size());
  const bool has_start = isWithin(static_cast<double>(scan.angle_min), kMaxInputAngle);
  const bool has_increment = std::isfinite(scan.angle_increment) && scan.angle_increment != 0.0f &&
                             std::abs(scan.angle_increment) * beams <= kMaxInputAngle;
  const bool runs_backwards = scan.angle_increment < 0.0f && scan.angle_max > scan.angle_min;
  const bool has_times =
      !deskew || (std::isfinite(scan.time_increment) && scan.time_increment >= 0.0f);
  const bool is_short = !deskew || static_cast<double>(scan.time_increment) * beams <= 2.0;
  const bool has_range = scan.range_max > scan.range_min;  // false where one is NaN
  if (!scan.ranges.empty() && has_start && has_increment && !runs_backwards && has_times &&
      is_short && has_range) {
    return {};
  }
  std::ostringstream problem;  // constructed only on errors
  if (scan.ranges.empty()) {
    problem << "the scan is empty; expected at least one range";
  } else if (!has_start) {
    problem << "the scan's angle_min is " << scan.angle_min
            << " rad; it must be finite and within two turns";
  } else if (!has_increment) {
    problem << "the scan's angle_increment is " << scan.angle_increment << " rad for "
            << scan.ranges.size()
            << " ranges; it must be finite, not zero, and span at most two turns";
  } else if (runs_backwards) {
    problem << "the scan's angle_increment is " << scan.angle_increment
            << " rad but angle_max is greater than angle_min";
  } else if (!has_times) {
    problem << "the scan's time_increment is " << scan.time_increment
            << " s; it must be finite and not negative, or deskew off";
  } else if (!is_short) {
    problem << "the scan's time_increment is " << scan.time_increment << " s for "
            << scan.ranges.size()
            << " ranges; a sweep must not take longer than 2 s, or deskew be off";
  } else {
    problem << "the scan's range_min " << scan.range_min << " m and range_max " << scan.range_max
            << " m leave no valid range";
  }
  return problem.str();
}

}  // namespace

std::string stripLeadingSlash(const std::string& frame) {
  const auto first = frame.find_first_not_of('/');
  return first == std::string::npos ? std::string() : frame.substr(first);
}

double yawOf(const geometry_msgs::Quaternion& quaternion) {
  return heading(normalized(quaternion));
}

geometry_msgs::Quaternion quaternionOf(double yaw) {
  geometry_msgs::Quaternion quaternion;
  quaternion.z = std::sin(yaw / 2.0);
  quaternion.w = std::cos(yaw / 2.0);
  return quaternion;
}

Pose2 toPose2(const geometry_msgs::Pose& pose) {
  const Pose2 planar{pose.position.x, pose.position.y, yawOf(pose.orientation)};
  if (!isWithin(planar, kMaxCoordinate)) {
    std::ostringstream problem;
    problem << "the position (" << planar.x << ", " << planar.y << ") must be finite and within "
            << kMaxCoordinate << " m";
    throw MessageError(problem.str());
  }
  return planar;
}

geometry_msgs::Pose toMessage(const Pose2& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose.x;
  message.position.y = pose.y;
  message.orientation = quaternionOf(pose.yaw);
  return message;
}

geometry_msgs::Transform toTransform(const Pose2& pose) {
  geometry_msgs::Transform transform;
  transform.translation.x = pose.x;
  transform.translation.y = pose.y;
  transform.rotation = quaternionOf(pose.yaw);
  return transform;
}

PoseEstimate toPoseEstimate(const geometry_msgs::PoseWithCovariance& pose) {
  PoseEstimate estimate;
  estimate.base_in_map = toPose2(pose.pose);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double cell = pose.covariance[static_cast<std::size_t>(kAxes[row] * 6 + kAxes[column])];
      if (!isWithin(cell, kMaxCoordinate * kMaxCoordinate)) {
        throw MessageError("the covariance of x, y and yaw must be finite and within 1e14");
      }
      estimate.covariance(row, column) = cell;
    }
  }
  return estimate;
}

geometry_msgs::PoseWithCovariance toMessage(const PoseEstimate& estimate) {
  geometry_msgs::PoseWithCovariance message;
  message.pose = toMessage(estimate.base_in_map);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      message.covariance[static_cast<std::size_t>(kAxes[row] * 6 + kAxes[column])] =
          estimate.covariance(row, column);
    }
  }
  return message;
}

OdometrySample toOdometrySample(const nav_msgs::Odometry& message) {
  OdometrySample sample;
  sample.stamp = message.header.stamp.toSec();
  const auto& twist = message.twist.twist;
  sample.twist = {twist.linear.x, twist.linear.y, twist.angular.z};
  try {
    sample.base_in_odom = toPose2(message.pose.pose);
  } catch (const MessageError&) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    sample.base_in_odom = {nan, nan, nan};
  }
  return sample;
}

GyroSample toGyroSample(const sensor_msgs::Imu& message,
                        const geometry_msgs::Quaternion& imu_in_base) {
  if (message.angular_velocity_covariance[0] == -1.0) {
    throw MessageError(
        "the IMU does not measure the angular velocity: angular_velocity_covariance[0] is -1");
  }
  const Quaternion q = normalized(imu_in_base);
  const geometry_msgs::Vector3& rate = message.angular_velocity;
  // The last row of the rotation matrix.
  return {message.header.stamp.toSec(), 2.0 * (q.x * q.z - q.w * q.y) * rate.x +
                                            2.0 * (q.y * q.z + q.w * q.x) * rate.y +
                                            upwards(q) * rate.z};
}

void requireOnCar(const Pose2& laser_in_base) {
  if (isWithin(laser_in_base, kMaxMountOffset)) return;
  std::ostringstream problem;
  problem << "the lidar is at (" << laser_in_base.x << ", " << laser_in_base.y << ", "
          << laser_in_base.yaw
          << ") in base_link; its position on the car must be finite and within " << kMaxMountOffset
          << " m";
  throw MessageError(problem.str());
}

LidarExtrinsics toLidarExtrinsics(const geometry_msgs::Transform& laser_in_base) {
  const Quaternion q = normalized(laser_in_base.rotation);
  const double up = upwards(q);
  if (std::abs(up) < std::cos(kMaxMountTilt)) {
    std::ostringstream problem;
    problem << "the lidar is tilted by " << std::acos(std::min(1.0, std::abs(up)))
            << " rad out of the plane; expected at most " << kMaxMountTilt;
    throw MessageError(problem.str());
  }
  LidarExtrinsics extrinsics;
  extrinsics.upside_down = up < 0.0;
  extrinsics.laser_in_base = {laser_in_base.translation.x, laser_in_base.translation.y, heading(q)};
  requireOnCar(extrinsics.laser_in_base);
  return extrinsics;
}

Scan toScan(const sensor_msgs::LaserScan& message, const LidarExtrinsics& extrinsics, bool deskew) {
  const std::string problem = problemOf(message, deskew);
  if (!problem.empty()) throw MessageError(problem);
  const double sense = extrinsics.upside_down ? -1.0 : 1.0;
  const auto count = static_cast<Eigen::Index>(message.ranges.size());
  Scan scan;
  scan.stamp = message.header.stamp.toSec();
  scan.laser_in_base = extrinsics.laser_in_base;
  scan.bearings.resize(count);
  scan.ranges.resize(count);
  scan.seconds_after_stamp.resize(count);
  const double period = deskew ? static_cast<double>(message.time_increment) : 0.0;
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    float range = message.ranges[static_cast<std::size_t>(i)];
    if (std::isnan(range) || range < message.range_min || range <= 0.0f) continue;
    if (range >= message.range_max) range = std::numeric_limits<float>::infinity();
    const double index = static_cast<double>(i);
    const double bearing = static_cast<double>(message.angle_min) +
                           index * static_cast<double>(message.angle_increment);
    scan.bearings[kept] = static_cast<float>(wrapAngle(sense * bearing));
    scan.ranges[kept] = range;
    scan.seconds_after_stamp[kept] = static_cast<float>(index * period);
    ++kept;
  }
  scan.bearings.conservativeResize(kept);
  scan.ranges.conservativeResize(kept);
  scan.seconds_after_stamp.conservativeResize(kept);
  return scan;
}

nav_msgs::Odometry toOdometryMessage(double stamp, const Pose2& pose, const Twist2& twist,
                                     const std::string& frame, const std::string& child_frame) {
  nav_msgs::Odometry message;
  message.header.stamp = timeOf(stamp);
  message.header.frame_id = frame;
  message.child_frame_id = child_frame;
  message.pose.pose = toMessage(pose);
  message.twist.twist.linear.x = twist.vx;
  message.twist.twist.linear.y = twist.vy;
  message.twist.twist.angular.z = twist.wz;
  return message;
}

geometry_msgs::TransformStamped toTransformMessage(double stamp, const Pose2& child_in_frame,
                                                   const std::string& frame,
                                                   const std::string& child_frame) {
  geometry_msgs::TransformStamped message;
  message.header.stamp = timeOf(stamp);
  message.header.frame_id = frame;
  message.child_frame_id = child_frame;
  message.transform = toTransform(child_in_frame);
  return message;
}

}  // namespace racecar_mcl
