// Parameters of the localizer and of its components.
#pragma once

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/monitoring/localization_monitor.h"
#include "racecar_mcl/monitoring/protection_level.h"
#include "racecar_mcl/motion/motion_model.h"
#include "racecar_mcl/motion/odometry_buffer.h"
#include "racecar_mcl/motion/odometry_calibration.h"
#include "racecar_mcl/scan/scan_preprocessor.h"
#include "racecar_mcl/sensor/range_bias.h"
#include "racecar_mcl/sensor/scan_direction.h"

namespace racecar_mcl {

enum class Relocalization {
  kFull,   ///< as kStart; a contradicted pose is searched again on the whole map
  kStart,  ///< a global start draws particles where the first scan matches; the result is confirmed
           ///< by a second search
  kOff,    ///< a global start draws particles evenly from free space, without a confirmation
};

struct LocalizerParameters {
  ParticleFilterParameters filter;
  MotionModelParameters motion;
  ScanParameters scan;
  SensorParameters sensor;
  OdometryParameters odometry;
  OdometryCalibrationParameters calibration;
  RangeBiasParameters range_bias;
  LocalizationMonitorParameters monitor;
  ProtectionLevelParameters protection;
  /// Number of independent beams that a scan counts as: the exponent of its likelihood is this
  /// divided by num_beams_per_particle.
  double effective_beams = 37.0;
  bool noise_adaptation = false;  ///< increase the motion noise while scans contradict the odometry
  bool slip_compensation = true;  ///< replace the odometry's speed where it cannot be the car's
  ScanDirectionFrom scan_direction = ScanDirectionFrom::kAuto;  ///< of the beams, for deskewing
  Relocalization relocalization = Relocalization::kFull;
  bool lidar_odometry = true;    ///< match scans with earlier ones where the map is incomplete
  bool distance_filter = false;  ///< reject beams that end at unmapped obstacles, while localized
  int stationary_updates = 40;   ///< scans used after the car has stopped; further ones would only
                                 ///< cause sample impoverishment
};

/// Throws ParameterError naming the parameter, its value and the allowed range.
void validate(const LocalizerParameters& parameters);

/// The parameters of the sensor models, with likelihood_exponent set from effective_beams.
SensorParameters sensorParameters(const LocalizerParameters& parameters);

/// makeLocalizationMap with the sensorParameters of these parameters.
std::shared_ptr<const LocalizationMap> makeLocalizationMap(OccupancyGrid grid,
                                                           const LocalizerParameters& parameters);

}  // namespace racecar_mcl
