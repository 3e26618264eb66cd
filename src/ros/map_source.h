// A map from disk, offered on topics and by service: what map_server does, which Debian does not
// have.
#pragma once

#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <string>

namespace racecar_mcl {

/// Publishes `map` (nav_msgs/OccupancyGrid) and `map_metadata` (nav_msgs/MapMetaData), both
/// latched, and serves `static_map` (nav_msgs/GetMap).
///
/// Private parameters: `yaml_filename`, the map's YAML, and `frame_id`, "map" by default. The
/// private service `reload` (std_srvs/Trigger) reads both again, so a map can be edited or
/// exchanged while running; where that fails, the map at hand stays and the response says why.
class MapSource {
 public:
  /// Reads and publishes the map. Throws ParameterError where a parameter is missing, MapError
  /// where the map cannot be read; then nothing is advertised.
  MapSource(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

  // The services are bound to this object.
  MapSource(const MapSource&) = delete;
  MapSource& operator=(const MapSource&) = delete;

 private:
  void load();
  void publish();
  bool serveMap(nav_msgs::GetMap::Request& request, nav_msgs::GetMap::Response& response);
  bool reload(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  nav_msgs::OccupancyGrid::ConstPtr map_;
  std::string summary_;  // one line about the map at hand
  ros::Publisher map_publisher_;
  ros::Publisher metadata_publisher_;
  ros::ServiceServer map_service_;
  ros::ServiceServer reload_service_;
};

}  // namespace racecar_mcl
