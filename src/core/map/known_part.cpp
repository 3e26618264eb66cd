#include "map/known_part.h"

#include <algorithm>
#include <cstdint>

#include "map/cell_window.h"

namespace racecar_mcl {
namespace {

// Unknown columns and rows on each side.
constexpr int kMargin = 2;

}  // namespace

KnownPart::KnownPart(const OccupancyGrid& whole) : whole_(&whole) {
  const GridGeometry& geometry = whole.geometry();
  CellWindow part = windowOf(whole.cells(), geometry, [](std::int8_t value) { return value >= 0; });
  if (part.empty()) return;
  part = {std::max(part.left - kMargin, 0), std::max(part.bottom - kMargin, 0),
          std::min(part.right + kMargin, geometry.width),
          std::min(part.top + kMargin, geometry.height)};
  if (part.width() == geometry.width && part.height() == geometry.height) return;
  part_.emplace(geometryOf(part, geometry), cut(whole.cells(), geometry, part));
}

}  // namespace racecar_mcl
