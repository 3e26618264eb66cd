// What the simulated car tells the ROS graph: its sensors, the clock, and, beside them, the truth.
#pragma once

#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <vector>

#include "ros/simulator_parameters.h"

namespace racecar_mcl {

/// Frames: odom -> base_link -> laser as on a car, and map -> base_link_truth, which is nobody
/// else's. The localizer adds map -> odom, or map -> base_link where odom -> base_link is off.
class SimulatorOutput {
 public:
  SimulatorOutput(ros::NodeHandle node, ros::NodeHandle private_node,
                  const SimulatorNodeParameters& parameters, bool publish_clock);

  /// s, added to every stamp from now on: by how much more simulated time is behind the wall's.
  void addDelay(double delay) { delay_ += delay; }

  void publishClock(double now);
  void publish(const sim::Event& event, const SimulatorNodeParameters& parameters);

  /// The car's place as rviz's tool would give it, to one subscriber alone.
  void announce(const ros::SingleSubscriberPublisher& subscriber, const Pose2& base_in_map,
                double now) const;

  /// Markers of all obstacles where they are at `now` (s).
  void publishObstacles(const std::vector<sim::Obstacle>& obstacles, double now);
  void publishCollisions(int count);

 private:
  void publishCar(const sim::CarParameters& car);

  double delay_ = 0.0;
  ros::Publisher clock_, scan_, odometry_, truth_, obstacles_, car_, collisions_;
  tf2_ros::TransformBroadcaster broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_broadcaster_;
};

}  // namespace racecar_mcl
