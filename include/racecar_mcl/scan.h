// A lidar sweep as the filter sees it: valid beams only, and the steps that prepare it for the
// filter.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/pose.h"

namespace racecar_mcl {

/// Valid beams of one sweep. Invalid returns (NaN, -inf, below range_min) were dropped where the
/// message was converted; +inf stays: nothing within the sensor's range is evidence (REP-117).
struct Scan {
  double stamp = 0.0;   ///< s, of the first beam
  Pose2 laser_in_base;  ///< where the lidar sits on the car
  Eigen::ArrayXf
      bearings;  ///< rad, counter-clockwise from the lidar's x axis, an upright lidar's sense
  Eigen::ArrayXf ranges;               ///< m; +inf = nothing within range
  Eigen::ArrayXf seconds_after_stamp;  ///< s, when each beam was taken; all zero for a flash lidar

  Eigen::Index size() const { return bearings.size(); }
};

/// At most `count` beams within +-`field_of_view` / 2 of the lidar's x axis, spread evenly over the
/// valid ones: those with a range above zero (+inf included), a finite bearing and a finite time. A
/// field of view of 2 pi or more keeps all bearings. Throws std::invalid_argument where the scan's
/// arrays differ in length.
Scan selectBeams(const Scan& scan, int count, double field_of_view);

/// The same, but spread evenly over the walls of a corridor: over the sides of a box about the
/// lidar that is `aspect` times as long, along the car's x axis, as it is wide. Evenly spread
/// bearings would crowd on the walls beside the car and leave few beams for those ahead. The beams
/// come in the order of their bearings, from the lidar's blind side on.
Scan selectBeamsBoxed(const Scan& scan, int count, double field_of_view, double aspect);

/// The beams of these indices alone.
Scan takeBeams(const Scan& scan, const std::vector<Eigen::Index>& chosen);

/// The sweep as it would have been seen had the car stood still at the scan's stamp: every end
/// point is moved by the car's motion between the stamp and its beam, then seen again from the
/// lidar's pose at the stamp. `base_after(t)` is the car's pose `t` seconds after the stamp in its
/// frame at the stamp. Beams without a return keep +inf and only turn.
template <typename PoseAfter>
Scan deskew(const Scan& scan, PoseAfter&& base_after) {
  Scan straight = scan;
  const Pose2 base_in_laser = inverse(scan.laser_in_base);
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const Pose2 base_in_start = base_after(static_cast<double>(scan.seconds_after_stamp[i]));
    const Pose2 laser_in_start_laser =
        compose(compose(base_in_laser, base_in_start), scan.laser_in_base);
    const double bearing = laser_in_start_laser.yaw + static_cast<double>(scan.bearings[i]);
    if (!std::isfinite(scan.ranges[i])) {
      straight.bearings[i] = static_cast<float>(wrapAngle(bearing));
      continue;
    }
    const double range = static_cast<double>(scan.ranges[i]);
    const double x = laser_in_start_laser.x + range * std::cos(bearing);
    const double y = laser_in_start_laser.y + range * std::sin(bearing);
    straight.bearings[i] = static_cast<float>(std::atan2(y, x));
    straight.ranges[i] = static_cast<float>(std::hypot(x, y));
  }
  straight.seconds_after_stamp.setZero();
  return straight;
}

}  // namespace racecar_mcl
