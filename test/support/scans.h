// Scans without surroundings: beams whose ranges tell them apart.
#pragma once

#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// Beams at steps of 1 degree, symmetric to the lidar's x axis and 1 ms apart; the range of beam i
/// is 1 + i.
inline Scan fan(int count) {
  Scan scan;
  scan.stamp = 12.5;
  scan.laser_in_base = {0.27, 0.01, 0.02};
  const double first = -(count - 1) / 2.0;
  scan.bearings = (Eigen::ArrayXf::LinSpaced(count, 0.0f, static_cast<float>(count - 1)) +
                   static_cast<float>(first)) *
                  static_cast<float>(kPi / 180.0);
  scan.ranges = Eigen::ArrayXf::LinSpaced(count, 1.0f, static_cast<float>(count));
  scan.seconds_after_stamp = 1e-3f * Eigen::ArrayXf::LinSpaced(count, 0.0f, count - 1.0f);
  return scan;
}

/// Three beams over 2 rad, evenly within 0.1 s.
inline Scan threeBeams() {
  Scan scan;
  scan.stamp = 7.0;
  scan.bearings = Eigen::ArrayXf::LinSpaced(3, -1.0f, 1.0f);
  scan.ranges = Eigen::ArrayXf::LinSpaced(3, 1.0f, 3.0f);
  scan.seconds_after_stamp = Eigen::ArrayXf::LinSpaced(3, 0.0f, 0.1f);
  return scan;
}

}  // namespace racecar_mcl
