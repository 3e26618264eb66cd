#include "ros/localization/visualization.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {
namespace {

constexpr double kArrowLength = 0.12;  // m
constexpr double kArrowHead = 0.04;    // m
// Clusters are drawn above the particles. Arrow lengths for weights of 0 and 1.
constexpr double kClusterHeight = 0.1;     // m
constexpr double kMinClusterLength = 0.3;  // m
constexpr double kMaxClusterLength = 1.0;  // m
constexpr double kClusterWidth = 0.08;     // m
constexpr double kTextHeight = 0.25;       // m
constexpr double kStatusDistance = 1.0;    // m, from the car to its status, along the map's y axis

/// Calls visit(i) for at most `limit` particles.
template <typename Visit>
void forEachShown(const ParticleSet& particles, Eigen::Index limit, Visit&& visit) {
  const Eigen::Index shown = std::min(limit, particles.size());
  for (Eigen::Index k = 0; k < shown; ++k) visit(k * particles.size() / shown);
}

/// Blue, green, red for 0 to 1.
std_msgs::ColorRGBA heatColour(double fraction) {
  std_msgs::ColorRGBA colour;
  colour.r = static_cast<float>(std::clamp(2.0 * fraction - 0.5, 0.0, 1.0));
  colour.g = static_cast<float>(std::clamp(1.0 - 2.0 * std::abs(fraction - 0.5), 0.15, 1.0));
  colour.b = static_cast<float>(std::clamp(1.0 - 2.0 * fraction, 0.0, 1.0));
  colour.a = 1.0f;
  return colour;
}

std_msgs::ColorRGBA stateColour(LocalizationState state) {
  std_msgs::ColorRGBA colour;
  colour.a = 1.0f;
  if (state == LocalizationState::kLocalized) {
    colour.g = 0.5f;
  } else if (state == LocalizationState::kLost) {
    colour.r = 0.85f;
  } else {
    colour.r = 0.75f;
    colour.g = 0.4f;
  }
  return colour;
}

geometry_msgs::Point pointAt(const Pose2& frame, double x, double y) {
  const Pose2 in_map = compose(frame, {x, y, 0.0});
  geometry_msgs::Point point;
  point.x = in_map.x;
  point.y = in_map.y;
  return point;
}

}  // namespace

geometry_msgs::PoseArray particleArray(const ParticleSet& particles, std_msgs::Header header,
                                       Eigen::Index limit) {
  geometry_msgs::PoseArray array;
  array.header = std::move(header);
  array.poses.reserve(static_cast<std::size_t>(std::min(limit, particles.size())));
  forEachShown(particles, limit,
               [&](Eigen::Index i) { array.poses.push_back(toMessage(particles.pose(i))); });
  return array;
}

visualization_msgs::MarkerArray particleMarkers(const ParticleSet& particles,
                                                std_msgs::Header header, Eigen::Index limit) {
  visualization_msgs::Marker marker;
  marker.header = std::move(header);
  marker.ns = "particles";
  marker.type = visualization_msgs::Marker::LINE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = 0.01;
  const double heaviest = particles.size() > 0 ? particles.log_weight.maxCoeff() : 0.0;
  forEachShown(particles, limit, [&](Eigen::Index i) {
    const Pose2 pose = particles.pose(i);
    const geometry_msgs::Point tip = pointAt(pose, kArrowLength, 0.0);
    const std_msgs::ColorRGBA colour = heatColour(std::exp(particles.log_weight[i] - heaviest));
    for (const geometry_msgs::Point& end :
         {pointAt(pose, 0.0, 0.0), pointAt(pose, kArrowLength - kArrowHead, kArrowHead / 2),
          pointAt(pose, kArrowLength - kArrowHead, -kArrowHead / 2)}) {
      marker.points.push_back(end);
      marker.points.push_back(tip);
      marker.colors.insert(marker.colors.end(), 2, colour);
    }
  });
  visualization_msgs::MarkerArray array;
  array.markers.push_back(std::move(marker));
  return array;
}

visualization_msgs::MarkerArray clusterMarkers(const std::vector<Cluster>& clusters,
                                               std_msgs::Header header, std::size_t limit) {
  visualization_msgs::MarkerArray array;
  visualization_msgs::Marker marker;
  marker.header = std::move(header);
  marker.pose.orientation.w = 1.0;
  marker.action = visualization_msgs::Marker::DELETEALL;
  array.markers.push_back(marker);

  marker.action = visualization_msgs::Marker::ADD;
  for (std::size_t i = 0; i < std::min(limit, clusters.size()); ++i) {
    const double weight = clusters[i].weight;
    marker.id = static_cast<std::int32_t>(i);
    marker.pose = toMessage(clusters[i].estimate.base_in_map);
    marker.pose.position.z = kClusterHeight;

    marker.ns = "means";
    marker.type = visualization_msgs::Marker::ARROW;
    marker.color = heatColour(weight);
    marker.scale.x = kMinClusterLength + (kMaxClusterLength - kMinClusterLength) * weight;
    marker.scale.y = marker.scale.z = kClusterWidth;
    marker.text.clear();
    array.markers.push_back(marker);

    marker.ns = "weights";
    marker.type = visualization_msgs::Marker::TEXT_VIEW_FACING;
    marker.pose.position.z = 2.0 * kClusterHeight;
    marker.scale.x = marker.scale.y = 0.0;
    marker.scale.z = kTextHeight;
    std::ostringstream text;
    text << std::fixed << std::setprecision(2) << weight;
    marker.text = text.str();
    array.markers.push_back(marker);
  }
  return array;
}

visualization_msgs::Marker statusMarker(const LocalizationStatus& status, const Pose2& base_in_map,
                                        std_msgs::Header header) {
  visualization_msgs::Marker marker;
  marker.header = std::move(header);
  marker.ns = "status";
  marker.type = visualization_msgs::Marker::TEXT_VIEW_FACING;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose = toMessage(Pose2{base_in_map.x, base_in_map.y + kStatusDistance, 0.0});
  marker.pose.position.z = 2.0 * kClusterHeight;
  marker.scale.z = kTextHeight;
  marker.color = stateColour(status.state);
  std::ostringstream text;
  text << std::fixed << toString(status.state) << '\n';
  if (status.state != LocalizationState::kLocalized) text << status.reason << '\n';
  text << std::setprecision(0) << "inliers " << 100.0 * status.inlier_ratio << " %\n";
  if (std::isfinite(status.level.along) && std::isfinite(status.level.across)) {
    text << "protection level " << std::setprecision(2) << status.level.along << " m along, "
         << status.level.across << " m across, " << std::setprecision(1)
         << status.level.heading * 180.0 / kPi << " deg";
  } else {
    text << "no protection level";
  }
  marker.text = text.str();
  return marker;
}

sensor_msgs::LaserScan expectedScan(const RangeCaster& caster, const Pose2& laser_in_map,
                                    bool upside_down, const sensor_msgs::LaserScan& real) {
  const auto count = static_cast<Eigen::Index>(real.ranges.size());
  const float sense = upside_down ? -1.0f : 1.0f;
  const Eigen::ArrayXf bearings =
      sense * (real.angle_min +
               real.angle_increment * Eigen::ArrayXf::LinSpaced(count, 0.0f, float(count - 1)));
  Eigen::ArrayXXf ranges(count, 1);
  caster.cast(batchOf(laser_in_map), bearings, ranges);

  sensor_msgs::LaserScan scan = real;
  scan.intensities.clear();
  const auto limit = static_cast<float>(caster.maxRange());
  for (Eigen::Index i = 0; i < count; ++i) {
    const float range = ranges(i, 0);
    scan.ranges[static_cast<std::size_t>(i)] =
        range < limit ? range : std::numeric_limits<float>::infinity();
  }
  return scan;
}

}  // namespace racecar_mcl
