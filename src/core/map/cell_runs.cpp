#include "racecar_mcl/map/cell_runs.h"

#include <algorithm>
#include <iterator>

namespace racecar_mcl {

void CellRuns::add(const Cell& cell) {
  if (!runs_.empty()) {
    Run& last = runs_.back();
    if (cell == Cell{last.first.column + last.count, last.first.row}) {
      ++last.count;
      return;
    }
  }
  runs_.push_back({cell, 1, size()});
}

Cell CellRuns::operator[](std::size_t index) const {
  const auto next =
      std::upper_bound(runs_.begin(), runs_.end(), index,
                       [](std::size_t wanted, const Run& run) { return wanted < run.before; });
  const Run& run = *std::prev(next);
  return {run.first.column + static_cast<int>(index - run.before), run.first.row};
}

std::vector<Cell> CellRuns::cells() const {
  std::vector<Cell> cells;
  cells.reserve(size());
  for (const Run& run : runs_) {
    for (int i = 0; i < run.count; ++i) {
      cells.push_back({run.first.column + i, run.first.row});
    }
  }
  return cells;
}

CellRuns freeCells(const OccupancyGrid& grid) {
  CellRuns cells;
  for (int row = 0; row < grid.geometry().height; ++row) {
    for (int column = 0; column < grid.geometry().width; ++column) {
      if (grid.isFree({column, row})) cells.add({column, row});
    }
  }
  return cells;
}

}  // namespace racecar_mcl
