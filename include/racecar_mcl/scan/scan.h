// Lidar scan with valid beams only.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// Maximum number of lidars of a car.
constexpr int kMaxLidars = 8;

/// Valid beams of one sweep. Invalid returns (NaN, -inf, below range_min) were dropped where the
/// message was converted; +inf (nothing within range) is kept as evidence (REP-117).
struct Scan {
  double stamp = 0.0;       ///< s, of the first beam
  int lidar = 0;            ///< index of the lidar that took it, below kMaxLidars
  Pose2 laser_in_base;      ///< mounting pose of the lidar
  Eigen::ArrayXf bearings;  ///< rad, counter-clockwise from the x axis of an upright lidar
  Eigen::ArrayXf ranges;    ///< m; +inf = nothing within range
  Eigen::ArrayXf
      seconds_after_stamp;  ///< s, acquisition time of each beam; all zero for a flash lidar

  Eigen::Index size() const { return bearings.size(); }
};

/// m, 2 x K: the ends of the beams in the frame of this pose of the lidar; not finite for beams
/// without a return.
Eigen::Matrix2Xd endPoints(const Pose2& lidar, const Scan& beams);

/// The beams with these indices.
Scan takeBeams(const Scan& scan, const std::vector<Eigen::Index>& chosen);

}  // namespace racecar_mcl
