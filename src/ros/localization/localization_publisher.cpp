#include "ros/localization/localization_publisher.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>

#include "ros/localization/diagnostics.h"
#include "ros/localization/visualization.h"

namespace racecar_mcl {
namespace {

constexpr double kStatusPeriod = 0.1;  // s, between messages of the same state

template <typename Make>
void publishIfSubscribed(const ros::Publisher& publisher, const Make& make) {
  if (publisher.getNumSubscribers() == 0) return;
  publisher.publish(boost::make_shared<std::decay_t<decltype(make())>>(make()));
}

}  // namespace

LocalizationPublisher::LocalizationPublisher(ros::NodeHandle node, const NodeParameters& parameters)
    : map_frame_(parameters.map_frame),
      base_frame_(parameters.particle_filter_frame),
      transform_tolerance_(parameters.transform_tolerance),
      visualization_period_(1.0 / parameters.visualization_rate),
      pose_(node.advertise<nav_msgs::Odometry>("pf/pose/odom", 10)),
      inferred_pose_(node.advertise<geometry_msgs::PoseStamped>("pf/viz/inferred_pose", 1)),
      amcl_pose_(node.advertise<geometry_msgs::PoseWithCovarianceStamped>("amcl_pose", 1, true)),
      status_(node.advertise<diagnostic_msgs::DiagnosticStatus>("pf/status", 10, true)),
      status_marker_(node.advertise<visualization_msgs::Marker>("pf/viz/status", 1)),
      particles_(node.advertise<geometry_msgs::PoseArray>("pf/viz/particles", 1)),
      markers_(node.advertise<visualization_msgs::MarkerArray>("pf/viz/particle_markers", 1)),
      clusters_(node.advertise<visualization_msgs::MarkerArray>("pf/viz/clusters", 1)),
      scan_(node.advertise<sensor_msgs::LaserScan>("pf/viz/scan", 1)),
      fake_scan_(node.advertise<sensor_msgs::LaserScan>("pf/viz/fake_scan", 1)) {}

void LocalizationPublisher::setParameters(const NodeParameters& parameters) {
  transform_tolerance_ = parameters.transform_tolerance;
  visualization_period_ = 1.0 / parameters.visualization_rate;
}

void LocalizationPublisher::publishPose(const PoseEstimate& estimate, const Twist2& twist,
                                        double stamp, bool after_scan) {
  auto odometry = boost::make_shared<nav_msgs::Odometry>(
      toOdometryMessage(stamp, estimate.base_in_map, twist, map_frame_, base_frame_));
  odometry->pose = toMessage(estimate);
  pose_.publish(odometry);
  publishIfSubscribed(inferred_pose_, [&] {
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

void LocalizationPublisher::publishStatus(const LocalizationStatus& status,
                                          const Pose2& base_in_map) {
  const ros::WallTime now = ros::WallTime::now();
  if (last_status_ == status.state && (now - last_status_time_).toSec() < kStatusPeriod) return;
  last_status_ = status.state;
  last_status_time_ = now;
  status_.publish(boost::make_shared<diagnostic_msgs::DiagnosticStatus>(toDiagnostics(status)));
  publishIfSubscribed(status_marker_, [&] {
    std_msgs::Header header;
    header.stamp = ros::Time::now();
    header.frame_id = map_frame_;
    return statusMarker(status, base_in_map, header);
  });
}

void LocalizationPublisher::broadcast(const std::string& child, const Pose2& child_in_map,
                                      double stamp) {
  broadcaster_.sendTransform(
      toTransformMessage(stamp + transform_tolerance_, child_in_map, map_frame_, child));
}

void LocalizationPublisher::publishScanTopics(const ParticleSet& particles,
                                              const LocalizationMap& map,
                                              const sensor_msgs::LaserScan& message,
                                              const LidarExtrinsics& extrinsics,
                                              const UpdateResult& update) {
  const ros::WallTime now = ros::WallTime::now();
  if ((now - last_visualization_).toSec() < visualization_period_) return;
  last_visualization_ = now;
  std_msgs::Header header;
  header.stamp = message.header.stamp;
  header.frame_id = map_frame_;
  publishIfSubscribed(particles_, [&] { return particleArray(particles, header); });
  publishIfSubscribed(markers_, [&] { return particleMarkers(particles, header); });
  if (!update.clusters.empty()) {
    publishIfSubscribed(clusters_, [&] { return clusterMarkers(update.clusters, header); });
  }
  publishIfSubscribed(scan_, [&] {
    sensor_msgs::LaserScan scan = message;
    scan.header.frame_id = stripLeadingSlash(scan.header.frame_id);
    return scan;
  });
  publishIfSubscribed(fake_scan_, [&] {
    const Pose2 laser_in_map = compose(update.estimate.base_in_map, extrinsics.laser_in_base);
    sensor_msgs::LaserScan scan =
        expectedScan(*map.caster, laser_in_map, extrinsics.upside_down, message);
    scan.header.frame_id = stripLeadingSlash(scan.header.frame_id);
    return scan;
  });
}

}  // namespace racecar_mcl
