// What a map offers a localizer: how much is free, what of its walls a lidar can see, and what is
// wrong with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/surfaces.h"

namespace racecar_mcl {

enum class MapKind {
  kNoFreeCells,
  kNoObstacles,
  kGrey,    ///< probabilities: a relevant number of values between 1 and 99
  kSlam,    ///< unknown outside
  kFilled,  ///< solid outside
  kOpen,    ///< free outside, as in floor plans on white
  kWalls,   ///< free space and its walls, hardly anything else
};

/// As in "SLAM map (unknown outside)".
std::string toString(MapKind kind);

struct MapSummary {
  GridGeometry geometry;
  MapKind kind = MapKind::kNoFreeCells;

  // Shares of all cells; together 1.
  double free_share = 0.0;
  double occupied_share = 0.0;
  double unknown_share = 0.0;

  double free_area = 0.0;  ///< m^2
  /// Free areas larger than 0.5 m^2 that no side of a cell connects.
  int free_areas = 0;
  double largest_free_area = 0.0;  ///< m^2
  /// Free cells at the border of the image.
  std::size_t free_cells_at_border = 0;

  std::size_t surface_cells = 0;
  /// m, a side for each surface cell: walls that slant are up to 1.4 times as long.
  double surface_length = 0.0;
  double blurred_area = 0.0;           ///< m^2, of blurred walls
  double blurred_surface_share = 0.0;  ///< of the surface cells, those of blurred walls
  /// Of the obstacle cells, those that are neither a surface nor in a blurred wall.
  double hidden_share = 0.0;
  /// Of the border of free space, the part that leads to the unknown or out of the image instead of
  /// to a wall. Counted where free space is 0.5 m wide and long: what was seen past it, through
  /// doors and glass, is strips of single beams, which have hardly any wall on any map.
  double opening_share = 0.0;

  /// What a user should know, each a line; empty for a sound map.
  std::vector<std::string> warnings;

  /// Whether there is something for a localizer to work with: free cells and obstacles.
  bool usable() const { return kind != MapKind::kNoFreeCells && kind != MapKind::kNoObstacles; }
};

/// `surfaces`: what findSurfaces gave of the grid. Passes over the cells only; no distance
/// transform.
MapSummary summarize(const OccupancyGrid& grid, const Surfaces& surfaces);

/// Size, kind, free area and surfaces in one line.
std::string describe(const MapSummary& summary);

/// 1 for a free cell at an opening, as opening_share counts them; row-major like the cells. One
/// unknown cell between free space and a wall is the wall, unknown specks in free space are free.
std::vector<std::uint8_t> findOpenings(const OccupancyGrid& grid);

}  // namespace racecar_mcl
