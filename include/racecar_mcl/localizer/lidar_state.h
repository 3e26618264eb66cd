// What the localizer keeps of each lidar of the car.
#pragma once

#include "racecar_mcl/scan/scan_preprocessor.h"
#include "racecar_mcl/sensor/range_bias.h"
#include "racecar_mcl/sensor/scan_direction.h"

namespace racecar_mcl {

struct LidarState {
  /// Throws as RangeBias.
  LidarState(const RangeBiasParameters& parameters, ScanDirectionFrom from)
      : range_bias(parameters), direction(from) {}

  RangeBias range_bias;
  ScanDirection direction;
  double travelled = 0.0;  ///< m since its last scan, by odometry
};

}  // namespace racecar_mcl
