// The parts of a map that global searches and their verification use.
#pragma once

#include "racecar_mcl/relocalization/global_scan_matcher.h"
#include "racecar_mcl/sensor/map_view.h"
#include "racecar_mcl/sensor/sensor_model.h"

namespace racecar_mcl {

/// Non-owning.
struct SearchMap {
  MapView view;
  const GlobalScanMatcher& matcher;
  SensorModel* sensor_model;  ///< for converged filters; before, the matcher's field is used
};

}  // namespace racecar_mcl
