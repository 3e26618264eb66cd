// Summary of a map for localization: free space, visible surfaces, and defects.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

enum class MapKind {
  kNoFreeCells,
  kNoObstacles,
  kGrey,    ///< probabilities: at least 1 % of the known cells are between 1 and 99
  kSlam,    ///< unknown outside
  kFilled,  ///< solid outside
  kOpen,    ///< free outside, as in floor plans on white
  kWalls,   ///< free space and its walls, less than 2 % of other cells
};

/// As in "SLAM map (unknown outside)".
std::string toString(MapKind kind);

struct MapSummary {
  GridGeometry geometry;
  MapKind kind = MapKind::kNoFreeCells;

  // Fractions of all cells; their sum is 1.
  double free_share = 0.0;
  double occupied_share = 0.0;
  double unknown_share = 0.0;

  double free_area = 0.0;  ///< m^2
  /// Number of free areas (connected across the sides of cells) larger than 0.5 m^2.
  int free_areas = 0;
  double largest_free_area = 0.0;  ///< m^2
  /// Free cells at the border of the image.
  std::size_t free_cells_at_border = 0;

  std::size_t surface_cells = 0;
  /// m, one cell side per surface cell; slanting walls are up to 1.4 times as long.
  double surface_length = 0.0;
  double blurred_area = 0.0;           ///< m^2, of blurred walls
  double blurred_surface_share = 0.0;  ///< fraction of the surface cells that are in blurred walls
  /// Fraction of the obstacle cells that are neither a surface nor in a blurred wall.
  double hidden_share = 0.0;
  /// Fraction of the border of free space that is unknown or the edge of the image instead of a
  /// wall. Only counted where free space is at least 0.5 m wide and long: areas seen through doors
  /// and glass are strips of single beams, which have few walls on any map.
  double opening_share = 0.0;

  /// Warnings for the user, one line each; empty if the map has no defects.
  std::vector<std::string> warnings;

  /// Whether localization is possible: the map has free cells and obstacles.
  bool usable() const { return kind != MapKind::kNoFreeCells && kind != MapKind::kNoObstacles; }
};

/// Linear in the number of cells.
MapSummary summarize(const OccupancyGrid& grid);

/// Size, kind, free area and surfaces in one line.
std::string describe(const MapSummary& summary);

/// 1 for a free cell at an opening, as counted by opening_share; row-major like the cells. A single
/// unknown cell between free space and a wall counts as wall, unknown specks in free space as free.
std::vector<std::uint8_t> findOpenings(const OccupancyGrid& grid);

}  // namespace racecar_mcl
