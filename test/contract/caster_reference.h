// Ranges by definition: the brute-force reference.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Intersects the ray with the square of every obstacle cell.
inline double bruteForceRange(const OccupancyGrid& grid, UnknownIs unknown_is, double max_range,
                              const Pose2& pose) {
  const GridGeometry& geometry = grid.geometry();
  const Eigen::Vector2d origin = worldToGrid(geometry, {pose.x, pose.y});
  const double angle = pose.yaw - geometry.origin.yaw;
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  if (unknown_is == UnknownIs::kOccupied && !contains(geometry, cellAt(geometry, {pose.x, pose.y})))
    return 0.0;

  const std::vector<std::uint8_t> mask = obstacleMask(grid, unknown_is);
  double nearest = max_range / geometry.resolution;
  const int ring = unknown_is == UnknownIs::kOccupied ? 1 : 0;
  for (int row = -ring; row < geometry.height + ring; ++row) {
    for (int column = -ring; column < geometry.width + ring; ++column) {
      const bool ends =
          !contains(geometry, {column, row}) ||
          mask[static_cast<std::size_t>(row) * static_cast<std::size_t>(geometry.width) +
               static_cast<std::size_t>(column)] != 0;
      if (!ends) continue;
      double enters = 0.0;
      double leaves = std::numeric_limits<double>::infinity();
      const double low[] = {static_cast<double>(column), static_cast<double>(row)};
      for (int axis = 0; axis < 2; ++axis) {
        const double a = (low[axis] - origin[axis]) / direction[axis];
        const double b = (low[axis] + 1.0 - origin[axis]) / direction[axis];
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
      }
      if (enters < leaves) nearest = std::min(nearest, enters);
    }
  }
  return nearest * geometry.resolution;
}

}  // namespace racecar_mcl
