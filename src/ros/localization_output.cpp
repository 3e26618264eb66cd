#include "ros/localization_output.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>

#include <algorithm>

#include "ros/diagnostics.h"
#include "ros/visualization.h"

namespace racecar_mcl {
namespace {

/// ros::Time throws beyond its range; what is stamped there stays there.
ros::Time timeOf(double stamp) {
  return ros::Time(std::clamp(stamp, 0.0, ros::TIME_MAX.toSec() - 1.0));
}

template <typename Make>
void publishIfHeard(const ros::Publisher& publisher, const Make& make) {
  if (publisher.getNumSubscribers() == 0) return;
  publisher.publish(boost::make_shared<std::decay_t<decltype(make())>>(make()));
}

}  // namespace

LocalizationOutput::LocalizationOutput(ros::NodeHandle node, const NodeParameters& parameters)
    : map_frame_(parameters.map_frame),
      base_frame_(parameters.particle_filter_frame),
      transform_tolerance_(parameters.transform_tolerance),
      visualization_period_(1.0 / parameters.visualization_rate),
      pose_(node.advertise<nav_msgs::Odometry>("pf/pose/odom", 10)),
      inferred_pose_(node.advertise<geometry_msgs::PoseStamped>("pf/viz/inferred_pose", 1)),
      amcl_pose_(node.advertise<geometry_msgs::PoseWithCovarianceStamped>("amcl_pose", 1, true)),
      verdict_(node.advertise<diagnostic_msgs::DiagnosticStatus>("pf/verdict", 10, true)),
      particles_(node.advertise<geometry_msgs::PoseArray>("pf/viz/particles", 1)),
      markers_(node.advertise<visualization_msgs::MarkerArray>("pf/viz/particle_markers", 1)),
      clusters_(node.advertise<visualization_msgs::MarkerArray>("pf/viz/clusters", 1)),
      scan_(node.advertise<sensor_msgs::LaserScan>("pf/viz/scan", 1)),
      fake_scan_(node.advertise<sensor_msgs::LaserScan>("pf/viz/fake_scan", 1)) {}

void LocalizationOutput::publishPose(const PoseEstimate& estimate, const Twist2& twist,
                                     double stamp, bool after_scan) {
  auto odometry = boost::make_shared<nav_msgs::Odometry>();
  odometry->header.stamp = timeOf(stamp);
  odometry->header.frame_id = map_frame_;
  odometry->child_frame_id = base_frame_;
  odometry->pose = toMessage(estimate);
  odometry->twist.twist.linear.x = twist.vx;
  odometry->twist.twist.linear.y = twist.vy;
  odometry->twist.twist.angular.z = twist.wz;
  pose_.publish(odometry);
  publishIfHeard(inferred_pose_, [&] {
    geometry_msgs::PoseStamped pose;
    pose.header = odometry->header;
    pose.pose = odometry->pose.pose;
    return pose;
  });
  if (!after_scan) return;
  auto amcl_pose = boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>();
  amcl_pose->header = odometry->header;
  amcl_pose->pose = odometry->pose;
  amcl_pose_.publish(amcl_pose);
}

void LocalizationOutput::publishVerdict(const Verdict& verdict) {
  if (last_verdict_ == verdict.state) return;
  last_verdict_ = verdict.state;
  verdict_.publish(boost::make_shared<diagnostic_msgs::DiagnosticStatus>(toDiagnostics(verdict)));
}

void LocalizationOutput::broadcast(const std::string& child, const Pose2& child_in_map,
                                   double stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = timeOf(stamp + transform_tolerance_);
  transform.header.frame_id = map_frame_;
  transform.child_frame_id = child;
  transform.transform = toTransform(child_in_map);
  broadcaster_.sendTransform(transform);
}

void LocalizationOutput::publishScanTopics(const ParticleSet& particles, const MapModel& map,
                                           const sensor_msgs::LaserScan& message,
                                           const LaserMount& mount, const UpdateResult& update) {
  const ros::WallTime now = ros::WallTime::now();
  if ((now - last_visualization_).toSec() < visualization_period_) return;
  last_visualization_ = now;
  std_msgs::Header header;
  header.stamp = message.header.stamp;
  header.frame_id = map_frame_;
  publishIfHeard(particles_, [&] { return particleArray(particles, header); });
  publishIfHeard(markers_, [&] { return particleMarkers(particles, header); });
  if (!update.clusters.empty()) {
    publishIfHeard(clusters_, [&] { return clusterMarkers(update.clusters, header); });
  }
  publishIfHeard(scan_, [&] {
    sensor_msgs::LaserScan scan = message;
    scan.header.frame_id = stripLeadingSlash(scan.header.frame_id);
    return scan;
  });
  publishIfHeard(fake_scan_, [&] {
    const Pose2 laser_in_map = compose(update.estimate.base_in_map, mount.laser_in_base);
    sensor_msgs::LaserScan scan = expectedScan(map, laser_in_map, mount.upside_down, message);
    scan.header.frame_id = stripLeadingSlash(scan.header.frame_id);
    return scan;
  });
}

}  // namespace racecar_mcl
