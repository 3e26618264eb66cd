// What the localizer has learned of a car's sensors, for its next start.
#pragma once

#include "racecar_mcl/motion/odometry_calibration.h"

namespace racecar_mcl {

struct SensorCalibration {
  OdometryErrors odometry;
  double range_bias = 0.0;     ///< m, measured ranges minus mapped distances
  bool scan_reversed = false;  ///< beams are listed in reverse acquisition order
};

}  // namespace racecar_mcl
