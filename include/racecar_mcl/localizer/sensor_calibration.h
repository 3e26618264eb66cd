// What the localizer has learned of a car's sensors, for its next start.
#pragma once

#include <vector>

#include "racecar_mcl/motion/odometry_calibration.h"

namespace racecar_mcl {

struct LidarCalibration {
  double range_bias = 0.0;     ///< m, measured ranges minus mapped distances
  bool scan_reversed = false;  ///< beams are listed in reverse acquisition order
};

struct SensorCalibration {
  OdometryErrors odometry;
  std::vector<LidarCalibration> lidars;  ///< by Scan::lidar
};

}  // namespace racecar_mcl
