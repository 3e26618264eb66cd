// Publishers of the localization node: poses, tf, status and visualization.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/transform_broadcaster.h>

#include <optional>
#include <string>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/monitoring/localization_monitor.h"
#include "ros/conversions/message_conversions.h"
#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

class LocalizationPublisher {
 public:
  /// Topics are relative to `node`.
  LocalizationPublisher(ros::NodeHandle node, const NodeParameters& parameters);

  /// For what may change at run time: transform_tolerance and visualization_rate.
  void setParameters(const NodeParameters& parameters);

  /// Publishes pf/pose/odom and pf/viz/inferred_pose; after a scan also amcl_pose.
  void publishPose(const PoseEstimate& estimate, const Twist2& twist, double stamp,
                   bool after_scan);

  /// Publishes pf/status, latched, and pf/viz/status: if the state has changed, else at 10 Hz.
  void publishStatus(const LocalizationStatus& status, const Pose2& base_in_map);

  /// Broadcasts map -> `child`, stamped transform_tolerance after `stamp`.
  void broadcast(const std::string& child, const Pose2& child_in_map, double stamp);

  /// Publishes particles, clusters (if the update has computed them) and scans, at most at
  /// visualization_rate and only on topics with subscribers. Not thread-safe.
  void publishScanTopics(const ParticleSet& particles, const LocalizationMap& map,
                         const sensor_msgs::LaserScan& message, const LidarExtrinsics& extrinsics,
                         const UpdateResult& update);

 private:
  std::string map_frame_;
  std::string base_frame_;
  double transform_tolerance_;
  double visualization_period_;
  ros::WallTime last_visualization_;
  ros::Publisher pose_, inferred_pose_, amcl_pose_;
  ros::Publisher status_, status_marker_;
  std::optional<LocalizationState> last_status_;
  ros::WallTime last_status_time_;
  ros::Publisher particles_, markers_, clusters_, scan_, fake_scan_;
  tf2_ros::TransformBroadcaster broadcaster_;
};

}  // namespace racecar_mcl
