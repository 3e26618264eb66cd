// A rectangular room with analytic ranges, without a grid or a ray caster.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// Walls at x = 0, x = width, y = 0 and y = height of the map frame, m.
struct Room {
  double width = 8.0;
  double height = 5.0;

  /// Distance to the wall from a point inside.
  double range(const Pose2& lidar_in_map, double bearing) const {
    const double angle = lidar_in_map.yaw + bearing;
    const auto until = [](double at, double along, double wall) {
      if (along == 0.0) return std::numeric_limits<double>::infinity();
      return ((along > 0.0 ? wall : 0.0) - at) / along;
    };
    return std::min(until(lidar_in_map.x, std::cos(angle), width),
                    until(lidar_in_map.y, std::sin(angle), height));
  }

  /// Distance of a point from the nearest wall's line.
  double distanceToWall(double x, double y) const {
    return std::min(std::min(std::abs(x), std::abs(x - width)),
                    std::min(std::abs(y), std::abs(y - height)));
  }

  /// Free inside, with one ring of occupied cells around it. Walls lie on cell borders where the
  /// room's sides are multiples of the resolution.
  OccupancyGrid grid(double resolution = 0.05) const {
    const int columns = static_cast<int>(std::lround(width / resolution)) + 2;
    const int rows = static_cast<int>(std::lround(height / resolution)) + 2;
    std::vector<std::int8_t> cells(static_cast<std::size_t>(columns * rows), OccupancyGrid::kFree);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        if (row == 0 || row == rows - 1 || column == 0 || column == columns - 1) {
          cells[static_cast<std::size_t>(row * columns + column)] = OccupancyGrid::kOccupied;
        }
      }
    }
    return {{columns, rows, resolution, {-resolution, -resolution, 0.0}}, std::move(cells)};
  }
};

/// A lidar: `count` beams over `field_of_view`, acquired one after another over `seconds`.
struct Sweep {
  int count = 180;
  double field_of_view = 4.7;  ///< rad
  double seconds = 0.0;        ///< 0 = all at once
  Pose2 laser_in_base;
};

/// A scan in the room from a car with the pose `base_in_map(t)` at time t.
template <typename BaseAt>
Scan takeScan(const Room& room, const Sweep& sweep, double stamp, BaseAt&& base_in_map) {
  Scan scan;
  scan.stamp = stamp;
  scan.laser_in_base = sweep.laser_in_base;
  scan.bearings.resize(sweep.count);
  scan.ranges.resize(sweep.count);
  scan.seconds_after_stamp.resize(sweep.count);
  for (int i = 0; i < sweep.count; ++i) {
    const double share = sweep.count == 1 ? 0.5 : static_cast<double>(i) / (sweep.count - 1);
    scan.bearings[i] = static_cast<float>((share - 0.5) * sweep.field_of_view);
    scan.seconds_after_stamp[i] = static_cast<float>(share * sweep.seconds);
    const Pose2 lidar = compose(
        base_in_map(stamp + static_cast<double>(scan.seconds_after_stamp[i])), sweep.laser_in_base);
    scan.ranges[i] = static_cast<float>(room.range(lidar, static_cast<double>(scan.bearings[i])));
  }
  return scan;
}

}  // namespace racecar_mcl
