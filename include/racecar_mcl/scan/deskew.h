// Deskewing: corrects a sweep for the car's motion during its acquisition.
#pragma once

#include <cmath>

#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// The sweep as seen from the lidar's pose at the scan's stamp: every end point is transformed by
/// the car's motion between the stamp and its beam. `base_after(t)`: the car's pose `t` seconds
/// after the stamp in its frame at the stamp. Beams without a return keep +inf; only their bearings
/// change.
template <typename PoseAfter>
Scan deskew(const Scan& scan, PoseAfter&& base_after) {
  Scan deskewed = scan;
  const Pose2 base_in_laser = inverse(scan.laser_in_base);
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const Pose2 base_in_start = base_after(static_cast<double>(scan.seconds_after_stamp[i]));
    const Pose2 laser_in_start_laser =
        compose(compose(base_in_laser, base_in_start), scan.laser_in_base);
    const double bearing = laser_in_start_laser.yaw + static_cast<double>(scan.bearings[i]);
    if (!std::isfinite(scan.ranges[i])) {
      deskewed.bearings[i] = static_cast<float>(wrapAngle(bearing));
      continue;
    }
    const double range = static_cast<double>(scan.ranges[i]);
    const double x = laser_in_start_laser.x + range * std::cos(bearing);
    const double y = laser_in_start_laser.y + range * std::sin(bearing);
    deskewed.bearings[i] = static_cast<float>(std::atan2(y, x));
    deskewed.ranges[i] = static_cast<float>(std::hypot(x, y));
  }
  deskewed.seconds_after_stamp.setZero();
  return deskewed;
}

}  // namespace racecar_mcl
