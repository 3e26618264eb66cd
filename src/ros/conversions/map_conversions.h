// Conversions between nav_msgs/OccupancyGrid and OccupancyGrid.
#pragma once

#include <nav_msgs/OccupancyGrid.h>

#include <string>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// The grid of a message. Frame, stamp and the origin's z are ignored.
///
/// Cells outside [0, 100] become unknown: the message defines -1, map_server's raw mode also sends
/// others. The resolution, a float in the message, becomes the shortest decimal that rounds to this
/// float, so that a map from a topic equals the same map from its file.
///
/// Throws MapError if OccupancyGrid rejects the grid, or if the origin's quaternion is zero, not
/// finite, or tilts the map out of the plane. Quaternions are normalised.
OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message);

/// The message of a grid; `stamp` is also the load time.
nav_msgs::OccupancyGrid toMessage(const OccupancyGrid& grid, const std::string& frame_id,
                                  const ros::Time& stamp);

}  // namespace racecar_mcl
