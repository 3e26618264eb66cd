#include "racecar_mcl/localizer/localizer_parameters.h"

#include <algorithm>
#include <utility>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {

void validate(const LocalizerParameters& p) {
  validate(p.filter);
  validate(p.motion);
  validate(p.scan);
  validate(p.sensor);
  validate(p.odometry);
  validate(p.calibration);
  validate(p.range_bias);
  validate(p.monitor);
  validate(p.protection);
  requireWithin("effective_beams", p.effective_beams, 0.1, 10000.0);
  require(p.stationary_updates >= 1, "stationary_updates", p.stationary_updates, "at least 1");
}

SensorParameters sensorParameters(const LocalizerParameters& parameters) {
  SensorParameters sensor = parameters.sensor;
  const double exponent =
      std::min(1.0, parameters.effective_beams / parameters.scan.num_beams_per_particle);
  sensor.field.likelihood_exponent = exponent;
  sensor.beam.likelihood_exponent = exponent;
  sensor.search.likelihood_exponent = exponent;
  return sensor;
}

std::shared_ptr<const LocalizationMap> makeLocalizationMap(OccupancyGrid grid,
                                                           const LocalizerParameters& parameters) {
  return makeLocalizationMap(std::move(grid), sensorParameters(parameters));
}

}  // namespace racecar_mcl
