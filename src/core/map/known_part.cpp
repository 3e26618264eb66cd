#include "map/known_part.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace racecar_mcl {
namespace {

// Unknown columns and rows on each side.
constexpr int kMargin = 2;

bool isKnown(std::int8_t value) { return value >= 0; }

/// A rectangle of a grid: [left, right) x [bottom, top).
struct Rectangle {
  int left, bottom, right, top;
};

/// Around the known cells; empty if there is none.
Rectangle boundsOfKnown(const OccupancyGrid& grid) {
  const int width = grid.geometry().width, height = grid.geometry().height;
  Rectangle bounds{width, height, 0, 0};
  const std::int8_t* cells = grid.cells().data();
  for (int row = 0; row < height; ++row, cells += width) {
    const auto first = static_cast<int>(std::find_if(cells, cells + width, isKnown) - cells);
    if (first == width) continue;
    int last = width - 1;
    while (!isKnown(cells[last])) --last;
    bounds.left = std::min(bounds.left, first);
    bounds.right = std::max(bounds.right, last + 1);
    bounds.bottom = std::min(bounds.bottom, row);
    bounds.top = row + 1;
  }
  return bounds;
}

OccupancyGrid cut(const OccupancyGrid& grid, const Rectangle& r) {
  GridGeometry geometry = grid.geometry();
  const double resolution = geometry.resolution;
  geometry.origin = compose(geometry.origin, {r.left * resolution, r.bottom * resolution, 0.0});
  geometry.width = r.right - r.left;
  geometry.height = r.top - r.bottom;
  std::vector<std::int8_t> cells;
  cells.reserve(static_cast<std::size_t>(geometry.width) *
                static_cast<std::size_t>(geometry.height));
  const CellIndex index(grid.geometry());
  for (int row = r.bottom; row < r.top; ++row) {
    const std::int8_t* const first = grid.cells().data() + index({r.left, row});
    cells.insert(cells.end(), first, first + geometry.width);
  }
  return {geometry, std::move(cells)};
}

}  // namespace

KnownPart::KnownPart(const OccupancyGrid& whole) : whole_(&whole) {
  const int width = whole.geometry().width, height = whole.geometry().height;
  Rectangle part = boundsOfKnown(whole);
  if (part.top == 0) return;
  part = {std::max(part.left - kMargin, 0), std::max(part.bottom - kMargin, 0),
          std::min(part.right + kMargin, width), std::min(part.top + kMargin, height)};
  if (part.right - part.left < width || part.top - part.bottom < height) part_ = cut(whole, part);
}

}  // namespace racecar_mcl
