#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

Eigen::Matrix2Xd endPoints(const Pose2& lidar, const Scan& beams) {
  const Eigen::ArrayXd angles = lidar.yaw + beams.bearings.cast<double>();
  const Eigen::ArrayXd ranges = beams.ranges.cast<double>();
  Eigen::Matrix2Xd ends(2, beams.size());
  ends.row(0) = (lidar.x + ranges * angles.cos()).transpose();
  ends.row(1) = (lidar.y + ranges * angles.sin()).transpose();
  return ends;
}

Scan takeBeams(const Scan& scan, const std::vector<Eigen::Index>& chosen) {
  const auto count = static_cast<Eigen::Index>(chosen.size());
  Scan taken;
  taken.stamp = scan.stamp;
  taken.lidar = scan.lidar;
  taken.laser_in_base = scan.laser_in_base;
  taken.bearings.resize(count);
  taken.ranges.resize(count);
  taken.seconds_after_stamp.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index i = chosen[static_cast<std::size_t>(k)];
    taken.bearings[k] = scan.bearings[i];
    taken.ranges[k] = scan.ranges[i];
    taken.seconds_after_stamp[k] = scan.seconds_after_stamp[i];
  }
  return taken;
}

}  // namespace racecar_mcl
