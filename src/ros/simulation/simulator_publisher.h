// Publishers of the simulator node: sensors, ground truth, clock and markers.
#pragma once

#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "ros/simulation/simulator_parameters.h"

namespace racecar_mcl {

/// Frames: odom -> base_link -> laser and laser_rear, and map -> base_link_truth. The localizer
/// adds map -> odom, or map -> base_link if publish_odom_tf is off.
class SimulatorPublisher {
 public:
  SimulatorPublisher(ros::NodeHandle node, ros::NodeHandle private_node,
                     const SimulatorNodeParameters& parameters, bool publish_clock);

  /// Adds to the offset of all later stamps, s: the lag of simulated time behind wall time.
  void addDelay(double delay) { delay_ += delay; }

  void publishClock(double now);
  void publish(const sim::Event& event, const SimulatorNodeParameters& parameters);

  /// Sends the car's pose as rviz's 2D Pose Estimate would, to this subscriber only.
  void announce(const ros::SingleSubscriberPublisher& subscriber, const Pose2& base_in_map,
                double now) const;

  /// Markers of all obstacles at time `now` (s).
  void publishObstacles(const std::vector<sim::Obstacle>& obstacles, double now);
  void publishCollisions(int count);

 private:
  void publishCar(const sim::CarParameters& car);

  double delay_ = 0.0;
  std::vector<ros::Publisher> scans_;  ///< by sim::LidarScan::lidar
  ros::Publisher clock_, odometry_, imu_, truth_, obstacles_, car_, collisions_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
};

}  // namespace racecar_mcl
