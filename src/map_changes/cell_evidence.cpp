#include "map_changes/cell_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/map/distance_field.h"
#include "racecar_mcl/map/surfaces.h"

namespace racecar_mcl {
namespace {

/// Calls visit(cell) for the cells on the segment, in grid coordinates, in order (Amanatides and
/// Woo, 1987).
template <typename Visit>
void traverse(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Visit&& visit) {
  const Eigen::Vector2d delta = to - from;
  Eigen::Vector2i cell = from.array().floor().cast<int>();
  const Eigen::Vector2i last = to.array().floor().cast<int>();
  Eigen::Vector2d next, step;  // fractions of the segment: to the next border, and per cell
  Eigen::Vector2i direction;
  for (int axis = 0; axis < 2; ++axis) {
    direction[axis] = delta[axis] > 0.0 ? 1 : -1;
    const double border = cell[axis] + (delta[axis] > 0.0 ? 1.0 : 0.0);
    const bool parallel = delta[axis] == 0.0;
    constexpr double kNever = std::numeric_limits<double>::infinity();
    next[axis] = parallel ? kNever : (border - from[axis]) / delta[axis];
    step[axis] = parallel ? kNever : 1.0 / std::abs(delta[axis]);
  }
  for (int cells = (last - cell).cwiseAbs().sum(); cells >= 0; --cells) {
    visit(Cell{cell.x(), cell.y()});
    const int axis = next.x() < next.y() ? 0 : 1;
    cell[axis] += direction[axis];
    next[axis] += step[axis];
  }
}

}  // namespace

CellEvidence::CellEvidence(const OccupancyGrid& grid)
    : geometry_(grid.geometry()),
      index_(geometry_),
      obstacles_(obstacleMask(grid, UnknownIs::kFree)),
      surface_distances_(
          obstacleDistances(findSurfaces(grid).visible, geometry_.width, geometry_.height)),
      cells_(grid.cells().size()),
      ended_(grid.cells().size(), 0),
      near_(grid.cells().size(), 0),
      passed_(grid.cells().size(), 0) {}

int CellEvidence::toleranceCells(double tolerance) const {
  return std::max(1, static_cast<int>(std::lround(tolerance / geometry_.resolution)));
}

void CellEvidence::add(const View& view) {
  ++views_;
  // All ends first: they decide where the view's beams pass.
  for (Eigen::Index k = 0; k < view.ends_in_map.cols(); ++k) {
    addEnd(view.ends_in_map.col(k), view.tolerances[k], view.stamp);
  }
  for (Eigen::Index k = 0; k < view.ends_in_map.cols(); ++k) {
    addPassed(view.lidar_in_map, view.ends_in_map.col(k), view.tolerances[k]);
  }
}

void CellEvidence::addEnd(const Eigen::Vector2d& end, double tolerance, double stamp) {
  const Cell at = cellAt(geometry_, end);
  const int reach = toleranceCells(tolerance);
  bool at_surface = false;
  for (int row = at.row - reach; row <= at.row + reach; ++row) {
    for (int column = at.column - reach; column <= at.column + reach; ++column) {
      if (!contains(geometry_, {column, row})) continue;
      const std::size_t i = index_({column, row});
      at_surface = at_surface || surface_distances_[i] == 0.0f;
      if (near_[i] == views_) continue;
      near_[i] = views_;
      ++cells_[i].ended_near;
    }
  }
  if (at_surface || !contains(geometry_, at)) return;
  const std::size_t i = index_(at);
  if (ended_[i] == views_) return;
  ended_[i] = views_;
  CellViews& cell = cells_[i];
  if (cell.ended++ == 0) cell.first_end = stamp;
  cell.last_end = stamp;
  cell.passed_after = 0;
}

void CellEvidence::addPassed(const Eigen::Vector2d& lidar, const Eigen::Vector2d& end,
                             double tolerance) {
  const Eigen::Vector2d from = worldToGrid(geometry_, lidar);
  const Eigen::Vector2d to = worldToGrid(geometry_, end);
  const auto reach = static_cast<float>(toleranceCells(tolerance));
  crossed_.clear();
  traverse(from, to, [&](const Cell& cell) {
    if (!contains(geometry_, cell)) return;
    const std::size_t i = index_(cell);
    if (near_[i] == views_) return;
    if (surface_distances_[i] > reach + 0.5f) {
      for (const std::size_t crossed : crossed_) pass(crossed);
      crossed_.clear();
    } else if (obstacles_[i] != 0) {
      crossed_.push_back(i);
      return;
    }
    pass(i);
  });
}

void CellEvidence::pass(std::size_t cell) {
  if (passed_[cell] == views_) return;
  passed_[cell] = views_;
  ++cells_[cell].passed;
  ++cells_[cell].passed_after;
}

}  // namespace racecar_mcl
