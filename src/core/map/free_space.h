// Free space of a map, its connected areas and its borders.
#pragma once

#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Masks over the cells of a grid, row-major like them.
struct FreeSpace {
  std::vector<std::uint8_t> free;
  /// The free cells and the unknown specks between them, up to two cells wide.
  std::vector<std::uint8_t> without_specks;
  /// Morphological opening of `without_specks` by a square of 0.5 m: areas that a car fits into.
  /// Areas seen through doors, between distant beams and through glass are thinner and have few
  /// walls.
  std::vector<std::uint8_t> roomy;
};

FreeSpace findFreeSpace(const OccupancyGrid& grid);

/// Numbers of sides of a free cell that are walls or openings, 0 to 4 each; the other sides are
/// free or specks.
struct CellSides {
  int walls = 0;
  int openings = 0;
};

CellSides sidesOf(const OccupancyGrid& grid, const FreeSpace& space, const Cell& cell);

/// The sizes, in cells, of the connected components of a mask (across the sides of cells).
std::vector<std::size_t> componentSizes(std::vector<std::uint8_t> mask, std::size_t width);

}  // namespace racecar_mcl
