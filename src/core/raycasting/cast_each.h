// Loop over poses and bearings for casters that cast one ray at a time.
#pragma once

#include <stdexcept>
#include <string>

#include "racecar_mcl/raycasting/range_caster.h"
#include "raycasting/beam_directions.h"
#include "raycasting/padded_grid.h"

namespace racecar_mcl {

/// Throws std::invalid_argument if `ranges` does not have a row per bearing and a column per pose.
inline void requireShape(const PoseBatch& poses, const Eigen::ArrayXf& bearings,
                         const Eigen::Ref<Eigen::ArrayXXf>& ranges) {
  if (ranges.rows() == bearings.size() && ranges.cols() == poses.size) return;
  throw std::invalid_argument("ranges of " + std::to_string(ranges.rows()) + " x " +
                              std::to_string(ranges.cols()) + " do not fit " +
                              std::to_string(bearings.size()) + " bearings x " +
                              std::to_string(poses.size) + " poses");
}

/// Fills `ranges` (m) by `traverse(ray, limit)`: the distance in cells from the ray's origin, a
/// point inside the map, to the first obstacle cell, at most `limit`.
template <typename Traverse>
void castEach(const PaddedGrid& grid, double max_range, const PoseBatch& lidar_in_map,
              const Eigen::ArrayXf& bearings, Eigen::Ref<Eigen::ArrayXXf> ranges,
              Traverse&& traverse) {
  requireShape(lidar_in_map, bearings, ranges);
  ranges.setConstant(static_cast<float>(max_range));
  const double limit = max_range / grid.resolution();
  for (Eigen::Index first = 0; first < bearings.size();) {
    const BeamDirections<double> beams(bearings, first);
    first = beams.end;
    for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
      if (!isFinite(lidar_in_map.pose(i))) continue;
      const PoseInCells pose = grid.toCells(lidar_in_map.pose(i));
      const bool inside = grid.contains(pose.position);
      for (std::size_t k = 0; k < static_cast<std::size_t>(beams.size); ++k) {
        RayInCells ray{pose.position.x(), pose.position.y(),
                       pose.cos_yaw * beams.cosine[k] - pose.sin_yaw * beams.sine[k],
                       pose.sin_yaw * beams.cosine[k] + pose.cos_yaw * beams.sine[k]};
        double cells = 0.0;
        if (inside || grid.outsideIsFree()) {
          const double before = inside ? 0.0 : grid.enter(ray);
          cells = before < limit ? before + traverse(ray, limit - before) : limit;
        }
        ranges(beams.index[k], i) = static_cast<float>(cells * grid.resolution());
      }
    }
  }
}

}  // namespace racecar_mcl
