// The visible wall surfaces of a map, and how to erase segments of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl::sim {

inline bool isOccupied(std::int8_t value) { return value >= OccupancyGrid::kObstacleFrom; }

/// The eight neighbours of a cell, possibly outside the grid; the four direct ones first.
inline std::array<Cell, 8> neighbours(const Cell& cell) {
  const int c = cell.column;
  const int r = cell.row;
  return {{{c + 1, r},
           {c - 1, r},
           {c, r + 1},
           {c, r - 1},
           {c + 1, r + 1},
           {c - 1, r + 1},
           {c + 1, r - 1},
           {c - 1, r - 1}}};
}

/// Cells are identified by their index.
class WallSurfaces {
 public:
  explicit WallSurfaces(const OccupancyGrid& map);

  /// The occupied cells with a free direct neighbour in the original map.
  const std::vector<std::size_t>& surface() const { return surface_; }
  /// The number of them that are not erased.
  std::size_t surfaceLeft() const;
  bool isErased(std::size_t cell) const { return !isOccupied(cells_[cell]); }

  /// Erases `length` m of surface around a surface cell, along the wall, and the wall behind it up
  /// to a depth of 1 m. The cells become free if they are surrounded by free cells only, else
  /// unknown.
  void erase(std::size_t centre, double length);

  const std::vector<std::int8_t>& cells() const { return cells_; }

 private:
  /// The cells that satisfy `among` and are connected to `from` within `steps`.
  template <typename Among>
  std::vector<std::size_t> reach(const std::vector<std::size_t>& from, int steps,
                                 Among&& among) const;
  std::int8_t behind(const std::vector<std::size_t>& erased) const;

  OccupancyGrid map_;
  std::vector<std::int8_t> cells_;
  std::vector<std::size_t> surface_;
  std::vector<std::uint8_t> is_surface_;
  std::vector<std::uint32_t> owner_;  ///< nearest surface cell of each occupied cell
  std::vector<std::uint16_t> depth_;  ///< steps from that surface cell
};

}  // namespace racecar_mcl::sim
