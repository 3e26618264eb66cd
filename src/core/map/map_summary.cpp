#include "racecar_mcl/map/map_summary.h"

#include <algorithm>
#include <utility>

#include "map/free_space.h"
#include "map/known_part.h"
#include "map/map_summary_text.h"
#include "racecar_mcl/map/surfaces.h"

namespace racecar_mcl {
namespace {

constexpr double kMinFreeArea = 0.5;         // m^2, of a free area that is counted
constexpr double kMinGreyRatio = 0.01;       // fraction of the known cells of a grey map
constexpr double kMinOutsideRatio = 0.02;    // unknown and hidden cells of a map with an outside
constexpr double kMinOpenBorderRatio = 0.5;  // free fraction of the image's border of an open map

/// Numbers of cells and of sides of cells.
struct Counts {
  std::size_t free = 0, occupied = 0, unknown = 0, grey = 0;
  std::size_t surface = 0, blurred = 0, blurred_surface = 0, hidden = 0;
  std::size_t free_at_border = 0;
  std::size_t wall_sides = 0;                                 ///< of all free cells
  std::size_t roomy_wall_sides = 0, roomy_opening_sides = 0;  ///< of the roomy ones
};

Counts count(const OccupancyGrid& grid, const Surfaces& surfaces, const FreeSpace& space) {
  const GridGeometry& geometry = grid.geometry();
  Counts n;
  std::size_t i = 0;
  for (int row = 0; row < geometry.height; ++row) {
    const bool at_end = row == 0 || row == geometry.height - 1;
    for (int column = 0; column < geometry.width; ++column, ++i) {
      const bool at_border = at_end || column == 0 || column == geometry.width - 1;
      const std::int8_t value = grid.cells()[i];
      if (value > OccupancyGrid::kFree && value < OccupancyGrid::kOccupied) ++n.grey;
      if (value < 0) {
        ++n.unknown;
      } else if (value < OccupancyGrid::kObstacleFrom) {
        ++n.free;
        if (at_border) ++n.free_at_border;
        const CellSides sides = sidesOf(grid, space, {column, row});
        n.wall_sides += static_cast<std::size_t>(sides.walls);
        if (space.roomy[i] != 0) {
          n.roomy_wall_sides += static_cast<std::size_t>(sides.walls);
          n.roomy_opening_sides += static_cast<std::size_t>(sides.openings);
        }
      } else {
        const bool visible = surfaces.visible[i] != 0, blurred = surfaces.blurred[i] != 0;
        ++n.occupied;
        if (visible) ++n.surface;
        if (blurred) ++n.blurred;
        if (visible && blurred) ++n.blurred_surface;
        if (!visible && !blurred) ++n.hidden;
      }
    }
  }
  return n;
}

/// The number of cells at the border of an image.
std::size_t borderCells(const GridGeometry& geometry) {
  const auto width = static_cast<std::size_t>(geometry.width);
  const auto height = static_cast<std::size_t>(geometry.height);
  return width < 2 || height < 2 ? width * height : 2 * (width + height) - 4;
}

/// part / whole; 0 if whole is 0.
double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

MapKind kindOf(const Counts& n, std::size_t border) {
  const std::size_t cells = n.free + n.occupied + n.unknown;
  if (n.free == 0) return MapKind::kNoFreeCells;
  if (n.occupied == 0) return MapKind::kNoObstacles;
  if (share(n.grey, n.free + n.occupied) >= kMinGreyRatio) return MapKind::kGrey;
  if (share(n.free_at_border, border) > kMinOpenBorderRatio) return MapKind::kOpen;
  if (share(n.unknown + n.hidden, cells) < kMinOutsideRatio) return MapKind::kWalls;
  return n.unknown >= n.hidden ? MapKind::kSlam : MapKind::kFilled;
}

}  // namespace

MapSummary summarize(const OccupancyGrid& grid) {
  const KnownPart known(grid);
  const OccupancyGrid& part = known.grid();
  FreeSpace space = findFreeSpace(part);
  Counts n = count(part, findSurfaces(part), space);
  const std::size_t cells = grid.cells().size();
  n.unknown += cells - part.cells().size();
  const double resolution = grid.geometry().resolution;
  const auto area = [&](std::size_t count) {
    return static_cast<double>(count) * resolution * resolution;
  };

  MapSummary s;
  s.geometry = grid.geometry();
  s.kind = kindOf(n, borderCells(grid.geometry()));
  s.free_share = share(n.free, cells);
  s.occupied_share = share(n.occupied, cells);
  s.unknown_share = share(n.unknown, cells);
  s.free_area = area(n.free);
  for (const std::size_t size :
       componentSizes(std::move(space.free), static_cast<std::size_t>(part.geometry().width))) {
    if (area(size) > kMinFreeArea) ++s.free_areas;
    s.largest_free_area = std::max(s.largest_free_area, area(size));
  }
  s.free_cells_at_border = n.free_at_border;
  s.surface_cells = n.surface;
  s.surface_length = static_cast<double>(n.surface) * resolution;
  s.blurred_area = area(n.blurred);
  s.blurred_surface_share = share(n.blurred_surface, n.surface);
  s.hidden_share = share(n.hidden, n.occupied);
  s.opening_share = share(n.roomy_opening_sides, n.roomy_opening_sides + n.roomy_wall_sides);
  s.warnings = warningsOf(s, n.wall_sides > 0);
  return s;
}

}  // namespace racecar_mcl
