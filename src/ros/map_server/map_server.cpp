#include "ros/map_server/map_server.h"

#include <boost/make_shared.hpp>
#include <sstream>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/map_io.h"
#include "ros/conversions/map_conversions.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {
namespace {

std::string requireYamlFilename(const ros::NodeHandle& private_node) {
  std::string path;
  if (!private_node.getParam("yaml_filename", path) || path.empty()) {
    throw ParameterError("the parameter " + private_node.resolveName("yaml_filename") +
                         " is not set; expected the path of a map's YAML file");
  }
  return path;
}

std::string requireFrameId(const ros::NodeHandle& private_node) {
  std::string frame_id = "map";
  if (private_node.hasParam("frame_id") && !private_node.getParam("frame_id", frame_id)) {
    frame_id.clear();
  }
  frame_id = stripLeadingSlash(frame_id);
  if (frame_id.empty()) {
    throw ParameterError("the parameter " + private_node.resolveName("frame_id") +
                         " is not a frame name; expected a string such as 'map'");
  }
  return frame_id;
}

std::string summarize(const OccupancyGrid& grid, const std::string& path) {
  const GridGeometry& geometry = grid.geometry();
  std::ostringstream text;
  text << "map '" << path << "': " << geometry.width << " x " << geometry.height << " cells of "
       << geometry.resolution << " m, origin (" << geometry.origin.x << ", " << geometry.origin.y
       << ", " << geometry.origin.yaw << ")";
  return text.str();
}

}  // namespace

MapServer::MapServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node)
    : node_(node), private_node_(private_node) {
  load();
  map_publisher_ = node_.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
  metadata_publisher_ = node_.advertise<nav_msgs::MapMetaData>("map_metadata", 1, true);
  publish();
  map_service_ = node_.advertiseService("static_map", &MapServer::serveMap, this);
  reload_service_ = private_node_.advertiseService("reload", &MapServer::reload, this);
}

void MapServer::load() {
  const std::string path = requireYamlFilename(private_node_);
  const std::string frame_id = requireFrameId(private_node_);
  const OccupancyGrid grid = loadMap(path);
  map_ = boost::make_shared<nav_msgs::OccupancyGrid>(toMessage(grid, frame_id, ros::Time::now()));
  summary_ = summarize(grid, path);
  if (log_throttle_.isDue()) ROS_INFO_STREAM(summary_);
  for (const auto& [is_missing, kind] :
       {std::pair{!hasFreeCell(grid), "free"}, std::pair{!hasObstacle(grid), "occupied"}}) {
    if (!is_missing || !log_throttle_.isDue()) continue;
    ROS_WARN_STREAM("map '" << path << "' has no " << kind << " cell; check its negate, " << kind
                            << "_thresh and mode");
  }
}

void MapServer::publish() {
  map_publisher_.publish(map_);
  metadata_publisher_.publish(map_->info);
}

bool MapServer::serveMap(nav_msgs::GetMap::Request& /*request*/,
                         nav_msgs::GetMap::Response& response) {
  response.map = *map_;
  return true;
}

bool MapServer::reload(std_srvs::Trigger::Request& /*request*/,
                       std_srvs::Trigger::Response& response) {
  try {
    load();
    publish();
    response.success = true;
    response.message = summary_;
  } catch (const std::exception& e) {
    if (log_throttle_.isDue("reload", e.what())) {
      ROS_ERROR_STREAM(
          "reload failed, keeping the current map: " << withoutControlCharacters(e.what()));
    }
    response.success = false;
    response.message = e.what();
  }
  return true;
}

}  // namespace racecar_mcl
