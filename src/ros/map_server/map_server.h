// Publishes a map from disk; replaces map_server, which Debian does not package.
#pragma once

#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <string>

#include "ros/util/log_throttle.h"

namespace racecar_mcl {

/// Publishes `map` (nav_msgs/OccupancyGrid) and `map_metadata` (nav_msgs/MapMetaData), both
/// latched, and serves `static_map` (nav_msgs/GetMap).
///
/// Private parameters: `yaml_filename`, the map's YAML, and `frame_id`, "map" by default. The
/// private service `reload` (std_srvs/Trigger) reads both again, so that a map can be
/// replaced while running; on failure the current map is kept and the response contains the reason.
class MapServer {
 public:
  /// Reads and publishes the map. Throws ParameterError if a parameter is missing and MapError if
  /// the map cannot be read; then nothing is advertised.
  MapServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

  // The services are bound to this object.
  MapServer(const MapServer&) = delete;
  MapServer& operator=(const MapServer&) = delete;

 private:
  void load();
  void publish();
  bool serveMap(nav_msgs::GetMap::Request& request, nav_msgs::GetMap::Response& response);
  bool reload(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  nav_msgs::OccupancyGrid::ConstPtr map_;
  LogThrottle log_throttle_;
  std::string summary_;  ///< one line about the current map
  ros::Publisher map_publisher_;
  ros::Publisher metadata_publisher_;
  ros::ServiceServer map_service_;
  ros::ServiceServer reload_service_;
};

}  // namespace racecar_mcl
