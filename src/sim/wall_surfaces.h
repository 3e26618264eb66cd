// The walls of a map by the surface that is seen of them, and how to take stretches of them away.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"

namespace racecar_mcl::sim {

inline bool isOccupied(std::int8_t value) { return value >= OccupancyGrid::kObstacleFrom; }

/// A cell's place among the cells of a grid, and back.
class CellIndex {
 public:
  explicit CellIndex(const GridGeometry& geometry) : width_(geometry.width) {}

  std::size_t operator()(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(cell.column);
  }
  Cell cell(std::size_t index) const {
    const auto i = static_cast<int>(index);
    return {i % width_, i / width_};
  }

 private:
  int width_;
};

/// The eight cells round a cell, some of them perhaps outside the grid; those beside it first.
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

/// Cells are named by their index.
class WallSurfaces {
 public:
  explicit WallSurfaces(const OccupancyGrid& map);

  /// The occupied cells that have a free one beside them, before anything was erased.
  const std::vector<std::size_t>& surface() const { return surface_; }
  /// How many of them are still there.
  std::size_t surfaceLeft() const;
  bool isErased(std::size_t cell) const { return !isOccupied(cells_[cell]); }

  /// Takes away `length` m of surface about a cell of it, measured along the wall, and the wall
  /// behind, up to a metre deep. The cells become free where nothing but free cells is round them,
  /// else unknown.
  void erase(std::size_t centre, double length);

  const std::vector<std::int8_t>& cells() const { return cells_; }

 private:
  /// The cells of `among` that lead from `from` to others of it in at most `steps`.
  template <typename Among>
  std::vector<std::size_t> reach(const std::vector<std::size_t>& from, int steps,
                                 Among&& among) const;
  std::int8_t behind(const std::vector<std::size_t>& erased) const;

  OccupancyGrid map_;
  std::vector<std::int8_t> cells_;
  std::vector<std::size_t> surface_;
  std::vector<std::uint8_t> is_surface_;
  std::vector<std::uint32_t> owner_;  ///< of each occupied cell: the nearest one of the surface
  std::vector<std::uint16_t> depth_;  ///< steps from there
};

}  // namespace racecar_mcl::sim
