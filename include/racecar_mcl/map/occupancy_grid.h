// Occupancy grid map: geometry (positions of cells) and cells (values).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// Pose and size of the grid in the map frame. Cell (0, 0) is the lower left one; `origin` is the
/// pose of its lower-left corner in the map frame. Columns run along the origin's x axis, rows
/// along its y axis:
///
///        y   row
///        ^    ^      origin.yaw rotates the grid about the corner o
///        |    | [0,1][1,1]
///        |    | [0,0][1,0]
///        |    o-------> column
///        +---------------> x
struct GridGeometry {
  int width = 0;            ///< columns
  int height = 0;           ///< rows
  double resolution = 0.0;  ///< m per cell
  Pose2 origin;             ///< pose of the lower-left corner in the map frame
};

/// A cell's indices.
struct Cell {
  int column = 0;
  int row = 0;
};

inline bool operator==(const Cell& a, const Cell& b) {
  return a.column == b.column && a.row == b.row;
}

/// Continuous grid coordinates in cells: (0, 0) is the corner of the grid, (0.5, 0.5) the centre of
/// cell (0, 0).
Eigen::Vector2d worldToGrid(const GridGeometry& geometry, const Eigen::Vector2d& point_in_map);
Eigen::Vector2d gridToWorld(const GridGeometry& geometry, const Eigen::Vector2d& point_in_grid);

/// The cell that contains a point of the map frame; its indices are clamped to just outside the
/// grid.
Cell cellAt(const GridGeometry& geometry, const Eigen::Vector2d& point_in_map);

/// The centre of a cell in the map frame.
Eigen::Vector2d cellCentre(const GridGeometry& geometry, const Cell& cell);

inline bool contains(const GridGeometry& geometry, const Cell& cell) {
  return cell.column >= 0 && cell.column < geometry.width && cell.row >= 0 &&
         cell.row < geometry.height;
}

/// Conversion between cells of a grid and their indices in row-major order, lowest row first.
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

/// Whether rays pass through unknown cells or end there.
enum class UnknownIs { kFree, kOccupied };

/// An immutable map. Cells hold nav_msgs values: 0 (free) to 100 (occupied), -1 unknown; row-major,
/// lowest row first.
class OccupancyGrid {
 public:
  static constexpr std::int8_t kFree = 0;
  static constexpr std::int8_t kOccupied = 100;
  static constexpr std::int8_t kUnknown = -1;
  /// A known cell with at least this value is an obstacle.
  static constexpr std::int8_t kObstacleFrom = 50;

  /// Throws MapError if the size is not positive, the resolution or the origin is not within the
  /// limits of common/limits.h, the number of cells does not match the size, or a value is outside
  /// [-1, 100].
  OccupancyGrid(GridGeometry geometry, std::vector<std::int8_t> cells);

  const GridGeometry& geometry() const { return geometry_; }
  const std::vector<std::int8_t>& cells() const { return cells_; }

  /// The value of a cell; kUnknown outside the grid.
  std::int8_t at(const Cell& cell) const {
    return contains(geometry_, cell) ? cells_[CellIndex(geometry_)(cell)] : kUnknown;
  }

  bool isFree(const Cell& cell) const {
    const std::int8_t value = at(cell);
    return value >= 0 && value < kObstacleFrom;
  }

 private:
  GridGeometry geometry_;
  std::vector<std::int8_t> cells_;
};

/// 1 for cells where rays end, 0 for others; row-major like the cells.
std::vector<std::uint8_t> obstacleMask(const OccupancyGrid& grid, UnknownIs unknown_is);

/// Whether any cell is free, or an obstacle.
bool hasFreeCell(const OccupancyGrid& grid);
bool hasObstacle(const OccupancyGrid& grid);

}  // namespace racecar_mcl
