// Surfaces of a map: the obstacle cells that a lidar can see from free space.
//
// Maps differ in the cells behind a wall: unknown (SLAM maps), a few cells, half a metre, or
// occupied to the edge of the image (race tracks). These cells never return a beam.
#pragma once

#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Thicker walls are filled areas.
constexpr double kMaxBlurredThickness = 1.3;  // m

/// Masks over the cells of a grid, row-major like them.
struct Surfaces {
  /// 1 for an obstacle cell that shares a side with a free cell, also across one unknown cell,
  /// since smoothed drawings have a grey cell between white and black. Cells that touch only at
  /// corners do not count: slanting walls would be two cells thick. If no obstacle is next to free
  /// space, all obstacle cells are surfaces.
  std::vector<std::uint8_t> visible;
  /// 1 for an obstacle cell in a blurred wall: one that is 0.45 to 1.3 m thick because the map was
  /// made with uncertain poses. The true surface is anywhere inside. Thinner walls are as precise
  /// as the cells, thicker ones are filled areas.
  std::vector<std::uint8_t> blurred;
};

Surfaces findSurfaces(const OccupancyGrid& grid);

/// Values of cells where a beam may end because the map lacks a surface.
constexpr std::uint8_t kBehindOpening = 1;
constexpr std::uint8_t kAtOpening = 2;

/// kAtOpening for free cells at most 0.1 m and unknown ones at most 0.15 m from an opening
/// (findOpenings), where the missing surface stands. kBehindOpening for other unknown cells at most
/// 1 m from it. 0 for cells that are not nearer to an opening than to a surface. Row-major like the
/// cells.
std::vector<std::uint8_t> findUnmapped(const OccupancyGrid& grid, const Surfaces& surfaces);

}  // namespace racecar_mcl
