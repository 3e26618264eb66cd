// What rviz shows of the filter. Each function builds one message; the node calls them for topics
// somebody hears.
#pragma once

#include <geometry_msgs/PoseArray.h>
#include <sensor_msgs/LaserScan.h>
#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "racecar_mcl/clusters.h"
#include "racecar_mcl/map_model.h"

namespace racecar_mcl {

/// At most `limit` particles, spread evenly over the set.
geometry_msgs::PoseArray particleArray(const ParticleSet& particles, std_msgs::Header header,
                                       Eigen::Index limit = 5000);

/// One marker of small arrows, from blue (light) to red (the heaviest).
visualization_msgs::MarkerArray particleMarkers(const ParticleSet& particles,
                                                std_msgs::Header header, Eigen::Index limit = 5000);

/// Where the car may be: for each of at most `limit` clusters, heaviest first, an arrow at its mean
/// (namespace "means"), the longer and redder the more weight it holds, and its share of the weight
/// as text (namespace "weights"). The first marker deletes those shown before.
visualization_msgs::MarkerArray clusterMarkers(const std::vector<Cluster>& clusters,
                                               std_msgs::Header header, std::size_t limit = 50);

/// The scan the map predicts for a lidar of this layout at this pose: the same angles as `real`.
sensor_msgs::LaserScan expectedScan(const MapModel& map, const Pose2& laser_in_map,
                                    bool upside_down, const sensor_msgs::LaserScan& real);

}  // namespace racecar_mcl
