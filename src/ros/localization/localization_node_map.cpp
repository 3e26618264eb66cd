// Part of LocalizationNode: receives maps, builds their lookup structures and switches to them.
#include <algorithm>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/printable.h"
#include "ros/conversions/map_conversions.h"
#include "ros/localization/localization_node.h"

namespace racecar_mcl {
namespace {

/// Throws MapError if the map has no free or no occupied cell and ParameterError if the pose lies
/// outside it.
void checkSetMap(const OccupancyGrid& grid, const Pose2& pose) {
  if (!hasFreeCell(grid)) throw MapError("the map has no free cell");
  if (!hasObstacle(grid)) throw MapError("the map has no occupied cell");
  if (!contains(grid.geometry(), cellAt(grid.geometry(), {pose.x, pose.y}))) {
    throw ParameterError("the initial pose lies outside the map");
  }
}

}  // namespace

void LocalizationNode::onMap(const nav_msgs::OccupancyGridConstPtr& message) {
  const std::string frame = stripLeadingSlash(message->header.frame_id);
  if (!frame.empty() && frame != parameters_.map_frame) {
    warnThrottled("map_frame", "the map is given in '" + printable(frame) + "' but poses in '" +
                                   parameters_.map_frame + "'; expected both to be the same frame");
  }
  if (!newest_map_.put(message)) map_builder_.post([this] { buildMap(); });
}

bool LocalizationNode::onSetMap(nav_msgs::SetMap::Request& request,
                                nav_msgs::SetMap::Response& response) {
  try {
    const PoseEstimate pose = toPoseEstimate(request.initial_pose.pose);
    checkSetMap(toOccupancyGrid(request.map), pose.base_in_map);
    onMap(boost::make_shared<nav_msgs::OccupancyGrid>(request.map));
    // Queued behind the map in the builder, so that the pose is checked against the new map.
    map_builder_.post([this, pose, stamp = request.initial_pose.header.stamp] {
      worker_.post([this, pose, stamp] { start(pose, stamp); });
    });
    response.success = true;
  } catch (const std::exception& error) {
    reportRejection(&NodeStatus::maps_rejected, "set_map rejected", error.what());
    response.success = false;
  }
  return true;
}

void LocalizationNode::buildMap() {
  const std::optional<nav_msgs::OccupancyGridConstPtr> message = newest_map_.take();
  if (!message) return;
  try {
    const std::shared_ptr<const LocalizationMap> map =
        makeLocalizationMap(toOccupancyGrid(**message), parameters_.localizer);
    worker_.post([this, map] { useMap(map); });
    // A task of its own: the first pose does not wait for it.
    map_builder_.post([this, map] {
      worker_.post([this, summary = summarize(map->grid)] { logSummary(summary); });
    });
  } catch (const std::exception& error) {
    reportRejection(&NodeStatus::maps_rejected, "map rejected, keeping the previous one",
                    error.what());
  }
}

void LocalizationNode::logSummary(const MapSummary& summary) {
  logEvent(describe(summary));
  for (const std::string& line : summary.warnings) {
    const bool known =
        std::find(map_warnings_.begin(), map_warnings_.end(), line) != map_warnings_.end();
    if (!known && log_throttle_.isDue()) ROS_WARN("map: %s", line.c_str());
  }
  map_warnings_ = summary.warnings;
}

void LocalizationNode::useMap(const std::shared_ptr<const LocalizationMap>& map) {
  const GridGeometry& geometry = map->grid.geometry();
  localizer_.setMap(map);
  updateNodeStatus();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    map_identity_ = mapIdentity(geometry);
  }
  const std::optional<PoseEstimate> pose =
      localizer_.estimateAt(localizer_.newestStamp().value_or(0.0));
  if (parameters_.global_start && !pose && !saved_pose_) startGlobally();
  if (pose && !contains(geometry, cellAt(geometry, {pose->base_in_map.x, pose->base_in_map.y}))) {
    reportRejection(nullptr, "map without the pose",
                    "the pose (" + std::to_string(pose->base_in_map.x) + ", " +
                        std::to_string(pose->base_in_map.y) +
                        ") lies outside the new map; expected a start pose on it");
  }
}

}  // namespace racecar_mcl
