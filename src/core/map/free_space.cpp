#include "map/free_space.h"

#include <algorithm>

#include "map/distance_transform.h"
#include "racecar_mcl/map/map_summary.h"

namespace racecar_mcl {
namespace {

constexpr double kCarSpace = 0.5;  // m, side of a square of free space that a car fits into

/// Whether the four cells beside a cell are free.
bool isAmongFree(const GridGeometry& geometry, const std::vector<std::uint8_t>& free,
                 const Cell& cell) {
  if (cell.column == 0 || cell.row == 0 || cell.column == geometry.width - 1 ||
      cell.row == geometry.height - 1) {
    return false;
  }
  const std::size_t i = CellIndex(geometry)(cell);
  const auto width = static_cast<std::size_t>(geometry.width);
  return free[i - 1] != 0 && free[i + 1] != 0 && free[i - width] != 0 && free[i + width] != 0;
}

}  // namespace

FreeSpace findFreeSpace(const OccupancyGrid& grid) {
  const GridGeometry& geometry = grid.geometry();
  const std::size_t size = grid.cells().size();
  FreeSpace space{std::vector<std::uint8_t>(size), {}, {}};
  std::transform(
      grid.cells().begin(), grid.cells().end(), space.free.begin(),
      [](std::int8_t value) { return value >= 0 && value < OccupancyGrid::kObstacleFrom ? 1 : 0; });
  const auto dilate = [&](const std::vector<std::uint8_t>& mask, int half) {
    return dilated(mask, geometry.width, geometry.height, half);
  };
  // Closing by 3 x 3 cells: an erosion is the dilation of the complement.
  space.without_specks = complement(dilate(complement(dilate(space.free, 1)), 1));
  for (std::size_t i = 0; i < size; ++i) {
    if (grid.cells()[i] >= 0) space.without_specks[i] = space.free[i];
  }
  const int half = static_cast<int>(0.5 * kCarSpace / geometry.resolution);
  space.roomy = dilate(complement(dilate(complement(space.without_specks), half)), half);
  return space;
}

CellSides sidesOf(const OccupancyGrid& grid, const FreeSpace& space, const Cell& cell) {
  constexpr Cell kSteps[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  CellSides sides;
  if (isAmongFree(grid.geometry(), space.free, cell)) return sides;
  for (const Cell& step : kSteps) {
    const Cell beside{cell.column + step.column, cell.row + step.row};
    if (grid.isFree(beside)) continue;
    if (grid.at(beside) >= 0) {
      ++sides.walls;
      continue;
    }
    // A single unknown cell before an obstacle is a smoothed wall.
    const Cell beyond{beside.column + step.column, beside.row + step.row};
    if (grid.at(beyond) >= OccupancyGrid::kObstacleFrom) {
      ++sides.walls;
    } else if (!contains(grid.geometry(), beside) ||
               space.without_specks[CellIndex(grid.geometry())(beside)] == 0) {
      ++sides.openings;
    }
  }
  return sides;
}

std::vector<std::size_t> componentSizes(std::vector<std::uint8_t> mask, std::size_t width) {
  const std::size_t size = mask.size();
  std::vector<std::size_t> sizes, stack;
  const auto visit = [&](std::size_t i) {
    if (mask[i] == 0) return;
    mask[i] = 0;
    stack.push_back(i);
    ++sizes.back();
  };
  for (std::size_t start = 0; start < size; ++start) {
    if (mask[start] == 0) continue;
    sizes.push_back(0);
    visit(start);
    while (!stack.empty()) {
      const std::size_t i = stack.back();
      stack.pop_back();
      const std::size_t column = i % width;
      if (column > 0) visit(i - 1);
      if (column + 1 < width) visit(i + 1);
      if (i >= width) visit(i - width);
      if (i + width < size) visit(i + width);
    }
  }
  return sizes;
}

std::vector<std::uint8_t> findOpenings(const OccupancyGrid& grid) {
  const FreeSpace space = findFreeSpace(grid);
  std::vector<std::uint8_t> openings(grid.cells().size(), 0);
  std::size_t i = 0;
  for (int row = 0; row < grid.geometry().height; ++row) {
    for (int column = 0; column < grid.geometry().width; ++column, ++i) {
      const Cell cell{column, row};
      if (space.free[i] == 0 || space.roomy[i] == 0) continue;
      openings[i] = sidesOf(grid, space, cell).openings > 0 ? 1 : 0;
    }
  }
  return openings;
}

}  // namespace racecar_mcl
