// Maps as messages: the one place where nav_msgs/OccupancyGrid becomes an OccupancyGrid and back.
#pragma once

#include <nav_msgs/OccupancyGrid.h>

#include <string>

#include "racecar_mcl/occupancy_grid.h"

namespace racecar_mcl {

/// The grid of a message. Its frame and its stamp are the caller's business; the origin's z is
/// ignored.
///
/// Cells outside [0, 100] are unknown: the message says -1, map_server's raw mode sends others too.
/// The resolution is a float in the message; it comes back as the shortest decimal that gives this
/// float, so that a map from a topic equals the same map from its file.
///
/// Throws MapError on what OccupancyGrid rejects, on a zero or non-finite quaternion and on one
/// that tilts the map out of the plane. A quaternion of another length
/// is normalised.
OccupancyGrid toOccupancyGrid(const nav_msgs::OccupancyGrid& message);

/// The message of a grid; `stamp` is also the load time.
nav_msgs::OccupancyGrid toMessage(const OccupancyGrid& grid, const std::string& frame_id,
                                  const ros::Time& stamp);

}  // namespace racecar_mcl
