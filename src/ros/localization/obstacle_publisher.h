// Publishers of the obstacles that the map lacks.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "racecar_mcl/localizer/obstacle_observer.h"
#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

/// Points x, y, z (float32, m) with z = 0, one row.
sensor_msgs::PointCloud2 obstacleCloud(const DetectedObstacles& obstacles, std_msgs::Header header);

/// For each track, with its id: a disc of its extent (namespace "extents"), an arrow from its
/// centre to where it is in a second (namespace "velocities"), and its speed in m/s as text
/// (namespace "speeds"). The first marker deletes the previous ones.
visualization_msgs::MarkerArray obstacleMarkers(const std::vector<ObstacleTrack>& tracks,
                                                std_msgs::Header header);

class ObstaclePublisher {
 public:
  /// Topics are relative to `node`.
  ObstaclePublisher(ros::NodeHandle node, const NodeParameters& parameters);

  /// For what may change at run time: obstacle_distance, obstacle_min_returns, visualization_rate.
  void setParameters(const NodeParameters& parameters);

  /// Publishes pf/obstacles and, at most at visualization_rate, pf/viz/obstacles. Computes only
  /// what has subscribers. `scan`: the newest of the localizer, with the stamp of its message and a
  /// result that has an estimate. Not thread-safe.
  void publish(const Localizer& localizer, const Scan& scan, const ros::Time& stamp,
               const ScanResult& result);

 private:
  std::string map_frame_;
  double visualization_period_;  ///< s
  ros::WallTime last_visualization_;
  ObstacleObserver observer_;
  ros::Publisher points_, markers_;
};

}  // namespace racecar_mcl
