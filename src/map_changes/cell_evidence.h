// Evidence about the cells of a map: the views in which beams ended in a cell or passed through it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// The returns of one scan at its estimated pose.
struct View {
  double stamp = 0.0;  ///< s
  Eigen::Vector2d lidar_in_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2Xd ends_in_map;  ///< m, 2 x K
  Eigen::ArrayXd tolerances;     ///< m, K: maximum error of each end point due to the pose
};

/// What the views say about one cell. Several beams of a view count once.
struct CellViews {
  std::uint32_t ended = 0;         ///< a beam ended in the cell, away from mapped surfaces
  std::uint32_t ended_near = 0;    ///< a beam ended in the cell or within the tolerance of it
  std::uint32_t passed = 0;        ///< beams passed through the cell, and none ended near it
  std::uint32_t passed_after = 0;  ///< of these, after the last one with an end in the cell
  double first_end = 0.0;          ///< s, stamps of `ended`
  double last_end = 0.0;
};

/// The tolerance is at least one cell: an end within it confirms a mapped surface. A beam passes
/// through a surface only if it ends farther behind it than that, so that a wrong pose does not
/// cut through walls at grazing angles.
class CellEvidence {
 public:
  explicit CellEvidence(const OccupancyGrid& grid);

  void add(const View& view);

  /// Row-major like the cells of the grid.
  const std::vector<CellViews>& cells() const { return cells_; }
  /// The number of views.
  std::uint32_t views() const { return views_; }

 private:
  int toleranceCells(double tolerance) const;
  void addEnd(const Eigen::Vector2d& end, double tolerance, double stamp);
  void addPassed(const Eigen::Vector2d& lidar, const Eigen::Vector2d& end, double tolerance);
  void pass(std::size_t cell);

  GridGeometry geometry_;
  CellIndex index_;
  std::vector<std::uint8_t> obstacles_;   ///< 1 for obstacle cells
  std::vector<float> surface_distances_;  ///< cells, to the nearest visible surface
  std::vector<CellViews> cells_;
  /// By cell: the number of the newest view that counted there, from 1.
  std::vector<std::uint32_t> ended_, near_, passed_;
  std::vector<std::size_t> crossed_;  ///< obstacle cells on the ray, not counted yet
  std::uint32_t views_ = 0;
};

}  // namespace racecar_mcl
