// View of many poses as arrays of their components.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// A non-owning view of N poses, one array per component (m, m, rad).
struct PoseBatch {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* yaw = nullptr;
  Eigen::Index size = 0;

  Pose2 pose(Eigen::Index i) const { return {x[i], y[i], yaw[i]}; }

  PoseBatch segment(Eigen::Index first, Eigen::Index count) const {
    return {x + first, y + first, yaw + first, count};
  }
};

/// A view of one pose, which must outlive it.
inline PoseBatch batchOf(const Pose2& pose) { return {&pose.x, &pose.y, &pose.yaw, 1}; }

}  // namespace racecar_mcl
