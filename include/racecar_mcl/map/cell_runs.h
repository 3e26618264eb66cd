// A set of cells as runs of consecutive cells of a row.
#pragma once

#include <cstddef>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// A run takes 24 bytes, whatever its length.
class CellRuns {
 public:
  struct Run {
    Cell first;
    int count;
    std::size_t before;  ///< cells of the runs before
  };

  /// Adds a cell after all others in row-major order.
  void add(const Cell& cell);

  std::size_t size() const {
    return runs_.empty() ? 0 : runs_.back().before + static_cast<std::size_t>(runs_.back().count);
  }
  bool empty() const { return runs_.empty(); }
  /// The cell of this index, which must be below size(); the time is logarithmic in the runs.
  Cell operator[](std::size_t index) const;
  const std::vector<Run>& runs() const { return runs_; }
  /// All cells.
  std::vector<Cell> cells() const;
  std::size_t memoryBytes() const { return runs_.size() * sizeof(Run); }

 private:
  std::vector<Run> runs_;
};

/// The free cells of a grid; may be empty.
CellRuns freeCells(const OccupancyGrid& grid);

}  // namespace racecar_mcl
