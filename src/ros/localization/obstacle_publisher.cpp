#include "ros/localization/obstacle_publisher.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <utility>

namespace racecar_mcl {
namespace {

constexpr double kMinDiameter = 0.1;     // m
constexpr double kDiscHeight = 0.1;      // m
constexpr double kVelocityHeight = 0.2;  // m, above the map
constexpr double kVelocityWidth = 0.06;  // m
constexpr double kVelocityHead = 0.15;   // m
constexpr double kSpeedHeight = 0.25;    // m
constexpr double kLifetime = 1.0;        // s, without a new scan

geometry_msgs::Point pointAt(const Eigen::Vector2d& in_map, double z) {
  geometry_msgs::Point point;
  point.x = in_map.x();
  point.y = in_map.y();
  point.z = z;
  return point;
}

std_msgs::ColorRGBA magenta(float alpha) {
  std_msgs::ColorRGBA colour;
  colour.r = 0.85f;
  colour.b = 0.6f;
  colour.a = alpha;
  return colour;
}

visualization_msgs::Marker disc(const ObstacleTrack& track, visualization_msgs::Marker marker) {
  marker.ns = "extents";
  marker.type = visualization_msgs::Marker::CYLINDER;
  marker.pose.position = pointAt(track.position_in_map, kDiscHeight / 2.0);
  marker.scale.x = marker.scale.y = std::max(kMinDiameter, track.extent);
  marker.scale.z = kDiscHeight;
  marker.color = magenta(0.5f);
  return marker;
}

visualization_msgs::Marker arrow(const ObstacleTrack& track, visualization_msgs::Marker marker) {
  marker.ns = "velocities";
  marker.type = visualization_msgs::Marker::ARROW;
  marker.points = {pointAt(track.position_in_map, kVelocityHeight),
                   pointAt(track.position_in_map + track.velocity_in_map, kVelocityHeight)};
  marker.scale.x = kVelocityWidth;
  marker.scale.y = 2.0 * kVelocityWidth;
  marker.scale.z = kVelocityHead;
  marker.color = magenta(1.0f);
  return marker;
}

visualization_msgs::Marker speedText(const ObstacleTrack& track,
                                     visualization_msgs::Marker marker) {
  marker.ns = "speeds";
  marker.type = visualization_msgs::Marker::TEXT_VIEW_FACING;
  marker.pose.position = pointAt(track.position_in_map, kVelocityHeight + kSpeedHeight);
  marker.scale.z = kSpeedHeight;
  marker.color = magenta(1.0f);
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << track.velocity_in_map.norm() << " m/s";
  marker.text = text.str();
  return marker;
}

}  // namespace

sensor_msgs::PointCloud2 obstacleCloud(const DetectedObstacles& obstacles,
                                       std_msgs::Header header) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header = std::move(header);
  cloud.is_dense = true;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2Fields(3, "x", 1, sensor_msgs::PointField::FLOAT32, "y", 1,
                                sensor_msgs::PointField::FLOAT32, "z", 1,
                                sensor_msgs::PointField::FLOAT32);
  modifier.resize(static_cast<std::size_t>(obstacles.points_in_map.cols()));
  if (cloud.data.empty()) return cloud;  // its iterator needs a point
  sensor_msgs::PointCloud2Iterator<float> point(cloud, "x");
  for (Eigen::Index k = 0; k < obstacles.points_in_map.cols(); ++k, ++point) {
    point[0] = static_cast<float>(obstacles.points_in_map(0, k));
    point[1] = static_cast<float>(obstacles.points_in_map(1, k));
    point[2] = 0.0f;
  }
  return cloud;
}

visualization_msgs::MarkerArray obstacleMarkers(const std::vector<ObstacleTrack>& tracks,
                                                std_msgs::Header header) {
  visualization_msgs::Marker marker;
  marker.header = std::move(header);
  marker.pose.orientation.w = 1.0;
  marker.action = visualization_msgs::Marker::DELETEALL;
  visualization_msgs::MarkerArray array;
  array.markers.push_back(marker);
  marker.action = visualization_msgs::Marker::ADD;
  marker.lifetime = ros::Duration(kLifetime);
  for (const ObstacleTrack& track : tracks) {
    marker.id = static_cast<std::int32_t>(track.id);
    array.markers.push_back(disc(track, marker));
    array.markers.push_back(arrow(track, marker));
    array.markers.push_back(speedText(track, marker));
  }
  return array;
}

ObstaclePublisher::ObstaclePublisher(ros::NodeHandle node, const NodeParameters& parameters)
    : map_frame_(parameters.map_frame),
      visualization_period_(1.0 / parameters.visualization_rate),
      observer_(parameters.obstacles),
      points_(node.advertise<sensor_msgs::PointCloud2>("pf/obstacles", 10)),
      markers_(node.advertise<visualization_msgs::MarkerArray>("pf/viz/obstacles", 1)) {}

void ObstaclePublisher::setParameters(const NodeParameters& parameters) {
  visualization_period_ = 1.0 / parameters.visualization_rate;
  observer_.setParameters(parameters.obstacles);
}

void ObstaclePublisher::publish(const Localizer& localizer, const Scan& scan,
                                const ros::Time& stamp, const ScanResult& result) {
  const bool has_points = points_.getNumSubscribers() > 0;
  const bool has_markers = markers_.getNumSubscribers() > 0;
  if (!has_points && !has_markers) return;
  const DetectedObstacles obstacles = observer_.detect(localizer, scan, result);
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = map_frame_;
  if (has_points) {
    points_.publish(boost::make_shared<sensor_msgs::PointCloud2>(obstacleCloud(obstacles, header)));
  }
  // Tracks are in the order of time; a late scan of another lidar has moved obstacles at another
  // one.
  if (!has_markers || result.stamp != scan.stamp) return;
  const std::vector<ObstacleTrack> tracks = observer_.track(obstacles, result);
  const ros::WallTime now = ros::WallTime::now();
  if ((now - last_visualization_).toSec() < visualization_period_) return;
  last_visualization_ = now;
  markers_.publish(
      boost::make_shared<visualization_msgs::MarkerArray>(obstacleMarkers(tracks, header)));
}

}  // namespace racecar_mcl
