// Messages of the simulated sensors.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>
#include <string>
#include <vector>

#include "ros/conversions/message_conversions.h"
#include "sim/simulator.h"

namespace racecar_mcl {

/// Topics and frames by LidarScan::lidar.
constexpr const char* kSimulatedScanTopics[] = {"scan", "scan_rear"};
constexpr const char* kSimulatedLidarFrames[] = {"laser", "laser_rear"};

/// base_link -> lidar, for each lidar of the car.
inline std::vector<geometry_msgs::TransformStamped> lidarTransforms(
    const sim::SimulatorParameters& parameters, double stamp) {
  std::vector<geometry_msgs::TransformStamped> transforms{toTransformMessage(
      stamp, parameters.lidar.laser_in_base, "base_link", kSimulatedLidarFrames[0])};
  if (parameters.rear_lidar.enabled) {
    transforms.push_back(toTransformMessage(stamp, parameters.rear_lidar.laser_in_base, "base_link",
                                            kSimulatedLidarFrames[1]));
  }
  return transforms;
}

inline sensor_msgs::LaserScan toMessage(const sim::LidarScan& sweep) {
  sensor_msgs::LaserScan message;
  message.header.stamp.fromSec(sweep.stamp);
  message.header.frame_id = kSimulatedLidarFrames[sweep.lidar];
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

/// Wheel odometry with the variances of its simulated errors.
inline nav_msgs::Odometry toMessage(const OdometrySample& sample,
                                    const sim::OdometryParameters& parameters,
                                    const std::string& frame, const std::string& child_frame) {
  nav_msgs::Odometry message =
      toOdometryMessage(sample.stamp, sample.base_in_odom, sample.twist, frame, child_frame);
  const auto variance = [](double noise, double systematic) {
    // At least (1 mm/s)^2, (1 mrad/s)^2: no message has zero variance.
    return std::max(noise * noise + systematic * systematic, 1e-6);
  };
  message.twist.covariance[0] =
      variance(parameters.noise.vx, parameters.speed_scale_error * sample.twist.vx);
  message.twist.covariance[7] = variance(parameters.noise.vy, 0.0);
  message.twist.covariance[35] =
      variance(parameters.noise.wz, parameters.rotation_scale_error * sample.twist.wz);
  // The integrated pose drifts without bound; values of common VESC drivers.
  message.pose.covariance[0] = 0.2;
  message.pose.covariance[7] = 0.2;
  message.pose.covariance[35] = 0.4;
  return message;
}

/// An IMU with a gyro only: orientation and acceleration are marked as not measured.
inline sensor_msgs::Imu toMessage(const GyroSample& sample, const std::string& frame) {
  sensor_msgs::Imu message;
  message.header.stamp.fromSec(sample.stamp);
  message.header.frame_id = frame;
  message.angular_velocity.z = sample.yaw_rate;
  message.orientation_covariance[0] = -1.0;
  message.linear_acceleration_covariance[0] = -1.0;
  return message;
}

}  // namespace racecar_mcl
