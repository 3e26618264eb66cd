// What casters that handle one ray at a time share: everything around the walk from cell to cell.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "racecar_mcl/range_caster.h"
#include "range_casters/padded_grid.h"

namespace racecar_mcl {

/// Unit vectors of the bearings, so that a ray costs an angle addition and no sine.
struct BearingDirections {
  explicit BearingDirections(const Eigen::ArrayXf& bearings)
      : cosine(bearings.cast<double>().cos()), sine(bearings.cast<double>().sin()) {}

  Eigen::ArrayXd cosine;
  Eigen::ArrayXd sine;
};

inline void requireShape(const PoseBatch& poses, const Eigen::ArrayXf& bearings,
                         const Eigen::Ref<Eigen::ArrayXXf>& ranges) {
  if (ranges.rows() == bearings.size() && ranges.cols() == poses.size) return;
  throw std::invalid_argument("ranges of " + std::to_string(ranges.rows()) + " x " +
                              std::to_string(ranges.cols()) + " do not fit " +
                              std::to_string(bearings.size()) + " bearings x " +
                              std::to_string(poses.size) + " poses");
}

/// Fills `ranges` (m) by `walk(ray, limit)`, which returns the distance in cells from the ray's
/// origin, a point of the map, to the first obstacle cell, at most `limit`.
template <typename Walk>
void castEach(const PaddedGrid& grid, double max_range, const PoseBatch& lidar_in_map,
              const Eigen::ArrayXf& bearings, Eigen::Ref<Eigen::ArrayXXf> ranges, Walk&& walk) {
  requireShape(lidar_in_map, bearings, ranges);
  const BearingDirections beams(bearings);
  const double limit = max_range / grid.resolution();
  for (Eigen::Index i = 0; i < lidar_in_map.size; ++i) {
    const double x = lidar_in_map.x[i];
    const double y = lidar_in_map.y[i];
    const double yaw = lidar_in_map.yaw[i];
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(yaw)) {
      ranges.col(i).setConstant(static_cast<float>(max_range));
      continue;
    }
    const PoseInCells pose = grid.toCells(x, y, yaw);
    const bool inside = grid.contains(pose.x, pose.y);
    if (!inside && !grid.outsideIsFree()) {
      ranges.col(i).setZero();
      continue;
    }
    for (Eigen::Index k = 0; k < bearings.size(); ++k) {
      RayInCells ray{pose.x, pose.y, pose.cos_yaw * beams.cosine[k] - pose.sin_yaw * beams.sine[k],
                     pose.sin_yaw * beams.cosine[k] + pose.cos_yaw * beams.sine[k]};
      const double before = inside ? 0.0 : grid.enter(ray);
      // The comparison is false for a bearing that is not finite, too.
      const bool reaches = before < limit && std::isfinite(ray.dx);
      const double cells = reaches ? before + walk(ray, limit - before) : limit;
      ranges(k, i) = static_cast<float>(cells * grid.resolution());
    }
  }
}

}  // namespace racecar_mcl
