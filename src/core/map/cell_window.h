// Rectangles of a grid's cells.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Columns and rows of a grid, also outside of it: [left, right) x [bottom, top).
struct CellWindow {
  int left, bottom, right, top;

  int width() const { return right - left; }
  int height() const { return top - bottom; }
  bool empty() const { return width() <= 0 || height() <= 0; }
};

/// The smallest window that contains both.
inline CellWindow hull(const CellWindow& a, const CellWindow& b) {
  return {std::min(a.left, b.left), std::min(a.bottom, b.bottom), std::max(a.right, b.right),
          std::max(a.top, b.top)};
}

/// The geometry of the window's cells.
inline GridGeometry geometryOf(const CellWindow& window, const GridGeometry& grid) {
  const Pose2 corner{window.left * grid.resolution, window.bottom * grid.resolution, 0.0};
  return {window.width(), window.height(), grid.resolution, compose(grid.origin, corner)};
}

/// The smallest window of the cells with the property; empty if there is none.
template <typename Value, typename Property>
CellWindow windowOf(const std::vector<Value>& cells, const GridGeometry& grid,
                    const Property& has_property) {
  CellWindow window{grid.width, grid.height, 0, 0};
  const Value* row_begin = cells.data();
  for (int row = 0; row < grid.height; ++row, row_begin += grid.width) {
    const Value* const row_end = row_begin + grid.width;
    const Value* const first = std::find_if(row_begin, row_end, has_property);
    if (first == row_end) continue;
    const Value* last = row_end - 1;
    while (!has_property(*last)) --last;
    window.left = std::min(window.left, static_cast<int>(first - row_begin));
    window.right = std::max(window.right, static_cast<int>(last - row_begin) + 1);
    window.bottom = std::min(window.bottom, row);
    window.top = row + 1;
  }
  return window;
}

/// The smallest window of the cells that are not 0.
inline CellWindow windowOfSet(const std::vector<std::uint8_t>& mask, const GridGeometry& grid) {
  return windowOf(mask, grid, [](std::uint8_t value) { return value != 0; });
}

/// The cells of the window, row by row; zeros outside of the grid.
template <typename Value>
std::vector<Value> cut(const std::vector<Value>& cells, const GridGeometry& grid,
                       const CellWindow& window) {
  std::vector<Value> part(static_cast<std::size_t>(window.width()) *
                          static_cast<std::size_t>(window.height()));
  const int left = std::max(window.left, 0);
  const int count = std::min(window.right, grid.width) - left;
  for (int row = std::max(window.bottom, 0); row < std::min(window.top, grid.height); ++row) {
    const std::ptrdiff_t to = static_cast<std::ptrdiff_t>(row - window.bottom) * window.width();
    std::copy_n(cells.begin() + static_cast<std::ptrdiff_t>(CellIndex(grid)({left, row})), count,
                part.begin() + to + (left - window.left));
  }
  return part;
}

}  // namespace racecar_mcl
