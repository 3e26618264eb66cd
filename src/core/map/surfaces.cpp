#include "racecar_mcl/map/surfaces.h"

#include <algorithm>
#include <iterator>

#include "racecar_mcl/map/distance_field.h"

namespace racecar_mcl {
namespace {

// Thickness of walls: thinner ones are sharp, those in between blurred, thicker ones filled areas
// (docs/decisions.md).
constexpr double kMinBlurredThickness = 0.45;  // m
constexpr double kMinFilledThickness = 1.3;    // m
// A cell belongs to a thick wall if it is within this many half thicknesses of its core.
constexpr float kCoreDistance = 1.5f;

bool isVisible(const OccupancyGrid& grid, const Cell& cell) {
  constexpr Cell kSides[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  return std::any_of(std::begin(kSides), std::end(kSides), [&](const Cell& side) {
    const Cell beside{cell.column + side.column, cell.row + side.row};
    const Cell beyond{beside.column + side.column, beside.row + side.row};
    return grid.isFree(beside) || (grid.at(beside) < 0 && grid.isFree(beyond));
  });
}

std::vector<std::uint8_t> visibleObstacles(const OccupancyGrid& grid,
                                           const std::vector<std::uint8_t>& obstacles) {
  std::vector<std::uint8_t> visible(obstacles.size(), 0);
  std::size_t i = 0;
  for (int row = 0; row < grid.geometry().height; ++row) {
    for (int column = 0; column < grid.geometry().width; ++column, ++i) {
      visible[i] = obstacles[i] != 0 && isVisible(grid, {column, row}) ? 1 : 0;
    }
  }
  const bool none = std::none_of(visible.begin(), visible.end(), [](auto v) { return v != 0; });
  return none ? obstacles : visible;
}

/// The obstacle cells of walls with at least this thickness (m): those near a cell whose depth is
/// half the thickness. `depth`: distance of each obstacle cell from the nearest other cell, in
/// cells.
std::vector<std::uint8_t> thickerThan(double thickness, const std::vector<std::uint8_t>& obstacles,
                                      const std::vector<float>& depth,
                                      const GridGeometry& geometry) {
  const auto half = static_cast<float>(0.5 * thickness / geometry.resolution);  // cells
  const std::size_t size = obstacles.size();
  std::vector<std::uint8_t> cores(size);
  for (std::size_t i = 0; i < size; ++i) cores[i] = obstacles[i] != 0 && depth[i] >= half ? 1 : 0;
  const std::vector<float> to_core = obstacleDistances(cores, geometry.width, geometry.height);
  std::vector<std::uint8_t> thick(size);
  for (std::size_t i = 0; i < size; ++i) {
    thick[i] = obstacles[i] != 0 && to_core[i] < kCoreDistance * half ? 1 : 0;
  }
  return thick;
}

/// The distance of each obstacle cell from the nearest other cell, in cells. Outside the grid all
/// cells count as obstacles if `continue_outside`, as none otherwise.
std::vector<float> depths(const std::vector<std::uint8_t>& obstacles, const GridGeometry& geometry,
                          bool continue_outside) {
  const int margin = continue_outside ? 0 : 1;
  const int width = geometry.width + 2 * margin;
  const int height = geometry.height + 2 * margin;
  std::vector<std::uint8_t> open(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                                 1);
  const auto at = [&](int column, int row) {
    return static_cast<std::size_t>(row + margin) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column + margin);
  };
  std::size_t i = 0;
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column) {
      open[at(column, row)] = obstacles[i++] == 0 ? 1 : 0;
    }
  }
  const std::vector<float> padded = obstacleDistances(open, width, height);
  std::vector<float> depth;
  depth.reserve(obstacles.size());
  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column) {
      depth.push_back(padded[at(column, row)]);
    }
  }
  return depth;
}

}  // namespace

Surfaces findSurfaces(const OccupancyGrid& grid) {
  const GridGeometry& geometry = grid.geometry();
  const std::vector<std::uint8_t> obstacles = obstacleMask(grid, UnknownIs::kFree);
  Surfaces surfaces{visibleObstacles(grid, obstacles), {}};
  // A wall at the edge of the image has the thickness drawn, but filled areas continue outside.
  surfaces.blurred =
      thickerThan(kMinBlurredThickness, obstacles, depths(obstacles, geometry, false), geometry);
  const std::vector<std::uint8_t> filled =
      thickerThan(kMinFilledThickness, obstacles, depths(obstacles, geometry, true), geometry);
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (filled[i] != 0) surfaces.blurred[i] = 0;
  }
  return surfaces;
}

}  // namespace racecar_mcl
