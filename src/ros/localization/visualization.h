// Visualization messages for rviz.
#pragma once

#include <geometry_msgs/PoseArray.h>
#include <sensor_msgs/LaserScan.h>
#include <visualization_msgs/Marker.h>
#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "racecar_mcl/filter/clustering.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/monitoring/localization_monitor.h"

namespace racecar_mcl {

/// At most `limit` particles, evenly sampled.
geometry_msgs::PoseArray particleArray(const ParticleSet& particles, std_msgs::Header header,
                                       Eigen::Index limit = 5000);

/// One marker of arrows, coloured from blue (low weight) to red (highest weight).
visualization_msgs::MarkerArray particleMarkers(const ParticleSet& particles,
                                                std_msgs::Header header, Eigen::Index limit = 5000);

/// Pose hypotheses: for each of at most `limit` clusters, by decreasing weight, an arrow at its
/// mean (namespace "means"), with length and colour by weight, and the weight as text (namespace
/// "weights"). The first marker deletes the previous ones.
visualization_msgs::MarkerArray clusterMarkers(const std::vector<Cluster>& clusters,
                                               std_msgs::Header header, std::size_t limit = 50);

/// The status as text beside the car, coloured by state: state, reason unless localized, inlier
/// ratio and protection level.
visualization_msgs::Marker statusMarker(const LocalizationStatus& status, const Pose2& base_in_map,
                                        std_msgs::Header header);

/// The expected scan at this pose, with the angles of `real`.
sensor_msgs::LaserScan expectedScan(const RangeCaster& caster, const Pose2& laser_in_map,
                                    bool upside_down, const sensor_msgs::LaserScan& real);

}  // namespace racecar_mcl
