// What the simulated car's sensors measure, as the messages a car publishes.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>
#include <string>

#include "ros/conversions.h"
#include "sim/simulator.h"

namespace racecar_mcl {

inline sensor_msgs::LaserScan toMessage(const sim::LidarScan& sweep, const std::string& frame) {
  sensor_msgs::LaserScan message;
  message.header.stamp.fromSec(sweep.stamp);
  message.header.frame_id = frame;
  message.angle_min = static_cast<float>(sweep.angle_min);
  message.angle_increment = static_cast<float>(sweep.angle_increment);
  message.angle_max = static_cast<float>(
      sweep.angle_min + sweep.angle_increment * static_cast<double>(sweep.ranges.size() - 1));
  message.time_increment = static_cast<float>(sweep.time_increment);
  message.scan_time = static_cast<float>(sweep.scan_time);
  message.range_min = static_cast<float>(sweep.range_min);
  message.range_max = static_cast<float>(sweep.range_max);
  message.ranges = sweep.ranges;
  return message;
}

/// A body's pose in `frame` and its twist in its own frame; covariances are left at zero.
inline nav_msgs::Odometry toOdometryMessage(double stamp, const Pose2& pose, const Twist2& twist,
                                            const std::string& frame,
                                            const std::string& child_frame) {
  nav_msgs::Odometry message;
  message.header.stamp.fromSec(stamp);
  message.header.frame_id = frame;
  message.child_frame_id = child_frame;
  message.pose.pose = toMessage(pose);
  message.twist.twist.linear.x = twist.vx;
  message.twist.twist.linear.y = twist.vy;
  message.twist.twist.angular.z = twist.wz;
  return message;
}

/// What the wheels say, with the variances of what is wrong with it.
inline nav_msgs::Odometry toMessage(const OdometrySample& sample,
                                    const sim::OdometryParameters& parameters,
                                    const std::string& frame, const std::string& child_frame) {
  nav_msgs::Odometry message =
      toOdometryMessage(sample.stamp, sample.base_in_odom, sample.twist, frame, child_frame);
  const auto variance = [](double noise, double systematic) {
    // Not below 1 mm/s (mrad/s): no message calls itself perfect.
    return std::max(noise * noise + systematic * systematic, 1e-6);
  };
  message.twist.covariance[0] =
      variance(parameters.noise.vx, parameters.speed_scale_error * sample.twist.vx);
  message.twist.covariance[7] = variance(parameters.noise.vy, 0.0);
  message.twist.covariance[35] =
      variance(parameters.noise.wz, parameters.turn_scale_error * sample.twist.wz);
  // The summed-up pose drifts without bound; these are the figures common VESC drivers give.
  message.pose.covariance[0] = 0.2;
  message.pose.covariance[7] = 0.2;
  message.pose.covariance[35] = 0.4;
  return message;
}

inline geometry_msgs::TransformStamped toTransformMessage(double stamp, const Pose2& child_in_frame,
                                                          const std::string& frame,
                                                          const std::string& child_frame) {
  geometry_msgs::TransformStamped message;
  message.header.stamp.fromSec(stamp);
  message.header.frame_id = frame;
  message.child_frame_id = child_frame;
  message.transform = toTransform(child_in_frame);
  return message;
}

}  // namespace racecar_mcl
