#include "racecar_mcl/map/surfaces.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "map/distance_transform.h"
#include "racecar_mcl/map/map_summary.h"

namespace racecar_mcl {
namespace {

// Thickness of walls: thinner ones are sharp, those in between blurred, thicker ones filled areas
// (docs/decisions.md).
constexpr double kMinBlurredThickness = 0.45;  // m
// A cell belongs to a thick wall if it is within this many half thicknesses of its core.
constexpr float kCoreDistance = 1.5f;
// Unmapped cells behind an opening and in front of it.
constexpr double kMaxUnmappedDepth = 1.0;  // m
constexpr double kMaxUnmappedFront = 0.1;  // m, since the missing surface ends at about the opening
constexpr double kOpeningDepth = 0.15;     // m

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

/// Half of a thickness, in cells.
float halfInCells(double thickness, const GridGeometry& geometry) {
  return static_cast<float>(0.5 * thickness / geometry.resolution);
}

/// Cells in the middle of walls: those at least half the minimum thickness from the nearest cell
/// that is no obstacle.
struct Cores {
  std::vector<std::uint8_t> blurred, filled;
};

Cores findCores(const std::vector<std::uint8_t>& obstacles, const GridGeometry& geometry) {
  Cores cores{std::vector<std::uint8_t>(obstacles.size()),
              std::vector<std::uint8_t>(obstacles.size())};
  const float half_blurred = halfInCells(kMinBlurredThickness, geometry);
  const float half_filled = halfInCells(kMaxBlurredThickness, geometry);
  const auto findInRow = [&](const DistanceTransform::Row& row) {
    for (int column = 0; column < geometry.width; ++column) {
      const std::size_t i = row.first + static_cast<std::size_t>(column);
      if (obstacles[i] == 0) continue;
      // A wall at the edge of the image has the thickness drawn, but filled areas continue outside.
      const float depth = row.distance(column);
      const int to_edge = 1 + std::min({column, row.row, geometry.width - 1 - column,
                                        geometry.height - 1 - row.row});
      cores.blurred[i] = std::min(depth, static_cast<float>(to_edge)) >= half_blurred ? 1 : 0;
      cores.filled[i] = depth >= half_filled ? 1 : 0;
    }
  };
  DistanceTransform(complement(obstacles), geometry.width, geometry.height, wholeCells(half_filled))
      .forEachRow(findInRow);
  return cores;
}

/// The obstacle cells of the walls with these cores: those within kCoreDistance half thicknesses of
/// one.
std::vector<std::uint8_t> wallsOf(const std::vector<std::uint8_t>& cores, double thickness,
                                  const std::vector<std::uint8_t>& obstacles,
                                  const GridGeometry& geometry) {
  std::vector<std::uint8_t> walls(obstacles.size());
  if (std::find(cores.begin(), cores.end(), 1) == cores.end()) return walls;
  const float reach = kCoreDistance * halfInCells(thickness, geometry);
  const auto findInRow = [&](const DistanceTransform::Row& row) {
    for (int column = 0; column < geometry.width; ++column) {
      const std::size_t i = row.first + static_cast<std::size_t>(column);
      walls[i] = obstacles[i] != 0 && row.distance(column) < reach ? 1 : 0;
    }
  };
  DistanceTransform(cores, geometry.width, geometry.height, wholeCells(reach))
      .forEachRow(findInRow);
  return walls;
}

}  // namespace

Surfaces findSurfaces(const OccupancyGrid& grid) {
  const GridGeometry& geometry = grid.geometry();
  const std::vector<std::uint8_t> obstacles = obstacleMask(grid, UnknownIs::kFree);
  const Cores cores = findCores(obstacles, geometry);
  Surfaces surfaces{visibleObstacles(grid, obstacles),
                    wallsOf(cores.blurred, kMinBlurredThickness, obstacles, geometry)};
  const std::vector<std::uint8_t> filled =
      wallsOf(cores.filled, kMaxBlurredThickness, obstacles, geometry);
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (filled[i] != 0) surfaces.blurred[i] = 0;
  }
  return surfaces;
}

std::vector<std::uint8_t> findUnmapped(const OccupancyGrid& grid, const Surfaces& surfaces) {
  const GridGeometry& geometry = grid.geometry();
  const std::vector<std::uint8_t> openings = findOpenings(grid);
  std::vector<std::uint8_t> unmapped(openings.size(), 0);
  if (std::find(openings.begin(), openings.end(), 1) == openings.end()) return unmapped;
  const int reach = wholeCells(kMaxUnmappedDepth / geometry.resolution);
  // Distances as 1 to 255, up to kMaxUnmappedDepth; those from an opening are kept in the mask.
  const auto stepsOf = [](double distance) { return 1.0 + 254.0 * distance / kMaxUnmappedDepth; };
  const auto forEachDistance = [&](const std::vector<std::uint8_t>& from, const auto& body) {
    DistanceTransform(from, geometry.width, geometry.height, reach)
        .forEachRow([&](const DistanceTransform::Row& row) {
          for (int column = 0; column < geometry.width; ++column) {
            body(row.first + static_cast<std::size_t>(column),
                 geometry.resolution * static_cast<double>(row.distance(column)));
          }
        });
  };
  forEachDistance(openings, [&](std::size_t i, double distance) {
    const std::int8_t value = grid.cells()[i];
    if (value >= OccupancyGrid::kObstacleFrom) return;
    if (distance > (value < 0 ? kMaxUnmappedDepth : kMaxUnmappedFront)) return;
    unmapped[i] = static_cast<std::uint8_t>(stepsOf(distance));
  });
  forEachDistance(surfaces.visible, [&](std::size_t i, double distance) {
    const bool nearer = std::floor(stepsOf(distance)) > static_cast<double>(unmapped[i]);
    if (unmapped[i] == 0) return;
    const bool is_at_opening = static_cast<double>(unmapped[i]) <= stepsOf(kOpeningDepth);
    unmapped[i] = !nearer ? 0 : is_at_opening ? kAtOpening : kBehindOpening;
  });
  return unmapped;
}

}  // namespace racecar_mcl
