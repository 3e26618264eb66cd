#include "racecar_mcl/sensor/unmapped_space.h"

#include "map/cell_window.h"

namespace racecar_mcl {
namespace {

// Errors of the pose bring beams that end on a wall into an opening along less than this.
constexpr double kMinLength = 0.5;  // m
// Beams in between that may end elsewhere, as on a box in front of the missing surface.
constexpr Eigen::Index kMaxBreak = 2;

}  // namespace

UnmappedSpace::UnmappedSpace(const GridGeometry& grid, const Surfaces& surfaces,
                             const std::vector<std::uint8_t>& unmapped,
                             const LikelihoodFieldParameters& parameters)
    : field_(grid, surfaces, unmapped, parameters) {
  const CellWindow window = windowOfSet(unmapped, grid);
  geometry_ = geometryOf(window, grid);
  cells_ = cut(unmapped, grid, window);
}

bool UnmappedSpace::isAtOpening(const Eigen::Vector2d& point_in_map) const {
  const Cell cell = cellAt(geometry_, point_in_map);
  return contains(geometry_, cell) && cells_[CellIndex(geometry_)(cell)] == kAtOpening;
}

bool UnmappedSpace::hasMissingSurface(const Pose2& lidar_in_map, const Scan& beams) const {
  const Eigen::Matrix2Xd ends = endPoints(lidar_in_map, beams);
  // The first and the last beam of a row of beams side by side.
  Eigen::Index first = -1, last = -1;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (!ends.col(k).allFinite() || !isAtOpening(ends.col(k))) continue;
    if (first < 0 || k - last > kMaxBreak + 1) first = k;
    last = k;
    if ((ends.col(last) - ends.col(first)).norm() >= kMinLength) return true;
  }
  return false;
}

std::optional<UnmappedSpace> findUnmappedSpace(const OccupancyGrid& grid, const Surfaces& surfaces,
                                               const LikelihoodFieldParameters& parameters) {
  if (parameters.unmapped_likelihood <= parameters.z_rand) return std::nullopt;
  const std::vector<std::uint8_t> unmapped = findUnmapped(grid, surfaces);
  if (windowOfSet(unmapped, grid.geometry()).empty()) return std::nullopt;
  return UnmappedSpace(grid.geometry(), surfaces, unmapped, parameters);
}

}  // namespace racecar_mcl
