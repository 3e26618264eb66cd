// The surfaces of a map: what of its obstacles a lidar can see from free space.
//
// Maps differ in what they draw behind a wall: nothing (a SLAM map's unknown), a few cells, half a
// metre of black, or black to the edge of the image (race tracks). None of that returns a beam.
#pragma once

#include <cstdint>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"

namespace racecar_mcl {

/// Masks over the cells of a grid, row-major like them.
struct Surfaces {
  /// 1 for an obstacle cell that shares a side with a free cell, also across one unknown cell:
  /// smoothed drawings put a grey cell between white and black. Across corners, slanting walls
  /// would be two cells thick. A map in which no obstacle is next to free space has all its
  /// obstacle cells as surfaces.
  std::vector<std::uint8_t> visible;
  /// 1 for an obstacle cell in a blurred wall: one between 0.45 and 1.3 m thick, as mapping with an
  /// uncertain pose draws it. The true surface lies anywhere inside. Thinner walls are as sharp as
  /// the cells, thicker ones are filled areas.
  std::vector<std::uint8_t> blurred;
};

Surfaces findSurfaces(const OccupancyGrid& grid);

}  // namespace racecar_mcl
