// A room for localization tests: unambiguous, with a rotated map.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// The room's corner in the map frame. The origin has a yaw, so that ignoring it fails every test.
inline Pose2 roomInMap() { return {-1.0, -2.0, 0.3}; }

/// 8 x 6 m with a corner cut off, a stub of a wall and a pillar; walls lie on the borders of cells,
/// one cell thick.
inline OccupancyGrid testRoom(double resolution = 0.05) {
  const auto is_inside = [](double x, double y) {
    const bool in_walls = x > 0.0 && x < 8.0 && y > 0.0 && y < 6.0;
    const bool in_step = x > 5.5 && y > 4.5;
    const bool in_stub = x < 1.5 && y > 1.8 && y < 2.0;
    const bool in_pillar = x > 1.0 && x < 1.5 && y > 4.0 && y < 4.5;
    return in_walls && !in_step && !in_stub && !in_pillar;
  };
  const int columns = static_cast<int>(std::lround(8.0 / resolution)) + 2;
  const int rows = static_cast<int>(std::lround(6.0 / resolution)) + 2;
  std::vector<std::int8_t> cells;
  cells.reserve(static_cast<std::size_t>(columns * rows));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      cells.push_back(is_inside((column - 0.5) * resolution, (row - 0.5) * resolution)
                          ? OccupancyGrid::kFree
                          : OccupancyGrid::kOccupied);
    }
  }
  const Pose2 origin = compose(roomInMap(), {-resolution, -resolution, 0.0});
  return OccupancyGrid({columns, rows, resolution, origin}, std::move(cells));
}

}  // namespace racecar_mcl
