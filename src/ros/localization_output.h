// What the localizer tells the ROS graph: poses, tf, and pictures for rviz.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/transform_broadcaster.h>

#include <optional>
#include <string>

#include "racecar_mcl/particle_filter.h"
#include "racecar_mcl/verdict.h"
#include "ros/conversions.h"
#include "ros/node_parameters.h"

namespace racecar_mcl {

class LocalizationOutput {
 public:
  /// Topics are relative to `node`.
  LocalizationOutput(ros::NodeHandle node, const NodeParameters& parameters);

  /// To pf/pose/odom and pf/viz/inferred_pose; after a scan to amcl_pose too.
  void publishPose(const PoseEstimate& estimate, const Twist2& twist, double stamp,
                   bool after_scan);

  /// To pf/verdict, latched, whenever its state changes.
  void publishVerdict(const Verdict& verdict);

  /// tf map -> `child`, stamped transform_tolerance after `stamp`.
  void broadcast(const std::string& child, const Pose2& child_in_map, double stamp);

  /// Particles, clusters (those of the newest update that looked for them) and scans, at most
  /// visualization_rate times a second and only for topics that somebody listens to. Not to be
  /// called from two threads.
  void publishScanTopics(const ParticleSet& particles, const MapModel& map,
                         const sensor_msgs::LaserScan& message, const LaserMount& mount,
                         const UpdateResult& update);

 private:
  std::string map_frame_;
  std::string base_frame_;
  double transform_tolerance_;
  double visualization_period_;
  ros::WallTime last_visualization_;
  ros::Publisher pose_, inferred_pose_, amcl_pose_;
  ros::Publisher verdict_;
  std::optional<VerdictState> last_verdict_;
  ros::Publisher particles_, markers_, clusters_, scan_, fake_scan_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace racecar_mcl
