// A map of a ring-shaped corridor around the origin of the map frame.
#pragma once

#include <cmath>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"
#include "sim/racing_path.h"

namespace racecar_mcl {

/// Free between both radii (m), occupied elsewhere; cells of 5 cm.
inline OccupancyGrid ringMap(double inner, double outer) {
  const int size = 2 * static_cast<int>(std::ceil((outer + 0.5) / 0.05));
  const double corner = -size * 0.05 / 2.0;
  const GridGeometry geometry{size, size, 0.05, {corner, corner, 0.0}};
  std::vector<std::int8_t> cells;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double radius = cellCentre(geometry, {column, row}).norm();
      const bool is_free = radius > inner && radius < outer;
      cells.push_back(is_free ? OccupancyGrid::kFree : OccupancyGrid::kOccupied);
    }
  }
  return {geometry, cells};
}

/// A circle around the origin, counter-clockwise from the x axis.
inline sim::Path circle(double radius, int points) {
  sim::Path path;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * kPi * i / points;
    path.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return path;
}

}  // namespace racecar_mcl
