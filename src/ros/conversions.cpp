#include "ros/conversions.h"

#include <cmath>
#include <limits>
#include <sstream>

namespace racecar_mcl {
namespace {

constexpr double kMaxTilt = 0.2;  // rad

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
            << ") is no orientation; expected a finite one of unit length";
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

/// What makes a scan unusable; empty where nothing does.
std::string problemOf(const sensor_msgs::LaserScan& scan) {
  const auto beams = static_cast<double>(scan.ranges.size());
  const bool turns = std::isfinite(scan.angle_increment) && scan.angle_increment != 0.0f &&
                     std::abs(scan.angle_increment) * beams <= 13.0;
  const bool runs_backwards = scan.angle_increment < 0.0f && scan.angle_max > scan.angle_min;
  const bool has_times = std::isfinite(scan.time_increment) && scan.time_increment >= 0.0f;
  const bool is_brief = static_cast<double>(scan.time_increment) * beams <= 2.0;
  const bool has_range = scan.range_max > scan.range_min;  // false where one is NaN
  if (!scan.ranges.empty() && std::isfinite(scan.angle_min) && turns && !runs_backwards &&
      has_times && is_brief && has_range) {
    return {};
  }
  std::ostringstream problem;  // costs more than all of the above
  if (scan.ranges.empty()) {
    problem << "the scan is empty; expected at least one range";
  } else if (!std::isfinite(scan.angle_min)) {
    problem << "the scan's angle_min is " << scan.angle_min << "; it must be finite";
  } else if (!turns) {
    problem << "the scan's angle_increment is " << scan.angle_increment << " rad for "
            << scan.ranges.size()
            << " ranges; it must be finite, not zero, and span at most two turns";
  } else if (runs_backwards) {
    problem << "the scan's angle_increment is " << scan.angle_increment
            << " rad though angle_max lies above angle_min";
  } else if (!has_times) {
    problem << "the scan's time_increment is " << scan.time_increment
            << " s; it must be finite and not negative";
  } else if (!is_brief) {
    problem << "the scan's time_increment is " << scan.time_increment << " s for "
            << scan.ranges.size() << " ranges; no sweep takes longer than 2 s";
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
  if (!isFinite(planar)) {
    std::ostringstream problem;
    problem << "the position (" << planar.x << ", " << planar.y << ") must be finite";
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
      if (!std::isfinite(cell)) {
        throw MessageError("the pose's covariance holds NaN or inf for x, y or yaw");
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

LaserMount toLaserMount(const geometry_msgs::Transform& laser_in_base) {
  const Quaternion q = normalized(laser_in_base.rotation);
  const double up = upwards(q);
  if (std::abs(up) < std::cos(kMaxTilt)) {
    std::ostringstream problem;
    problem << "the lidar is tilted by " << std::acos(std::min(1.0, std::abs(up)))
            << " rad out of the plane; expected at most " << kMaxTilt;
    throw MessageError(problem.str());
  }
  LaserMount mount;
  mount.upside_down = up < 0.0;
  mount.laser_in_base = {laser_in_base.translation.x, laser_in_base.translation.y, heading(q)};
  if (!isFinite(mount.laser_in_base)) {
    throw MessageError("the lidar's position on the car must be finite");
  }
  return mount;
}

Scan toScan(const sensor_msgs::LaserScan& message, const LaserMount& mount) {
  const std::string problem = problemOf(message);
  if (!problem.empty()) throw MessageError(problem);
  const double sense = mount.upside_down ? -1.0 : 1.0;
  const auto count = static_cast<Eigen::Index>(message.ranges.size());
  Scan scan;
  scan.stamp = message.header.stamp.toSec();
  scan.laser_in_base = mount.laser_in_base;
  scan.bearings.resize(count);
  scan.ranges.resize(count);
  scan.seconds_after_stamp.resize(count);
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    float range = message.ranges[static_cast<std::size_t>(i)];
    if (std::isnan(range) || range < message.range_min || range <= 0.0f) continue;
    if (range > message.range_max) range = std::numeric_limits<float>::infinity();
    const double index = static_cast<double>(i);
    const double bearing = static_cast<double>(message.angle_min) +
                           index * static_cast<double>(message.angle_increment);
    scan.bearings[kept] = static_cast<float>(wrapAngle(sense * bearing));
    scan.ranges[kept] = range;
    scan.seconds_after_stamp[kept] =
        static_cast<float>(index * static_cast<double>(message.time_increment));
    ++kept;
  }
  scan.bearings.conservativeResize(kept);
  scan.ranges.conservativeResize(kept);
  scan.seconds_after_stamp.conservativeResize(kept);
  return scan;
}

}  // namespace racecar_mcl
