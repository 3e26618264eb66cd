#include "sensor/beam_residuals.h"

#include <algorithm>
#include <limits>

namespace racecar_mcl {

void computeBeamResiduals(const MapView& map, const Pose2& base_in_map, const Scan& scan,
                          BeamResiduals* residuals) {
  const Pose2 lidar = compose(base_in_map, scan.laser_in_base);
  Eigen::ArrayXXf& expected = residuals->expected_ranges;
  expected.resize(scan.size(), 1);
  map.caster.cast(batchOf(lidar), scan.bearings, expected);
  // A ray of maximum range hits no surface.
  const auto max_range = static_cast<float>(map.caster.maxRange());
  for (Eigen::Index k = 0; k < scan.size(); ++k) {
    if (!(expected(k) < max_range)) expected(k) = std::numeric_limits<float>::quiet_NaN();
  }
  residuals->log_likelihoods.resize(scan.size());
  map.field.beamLogLikelihoods(batchOf(lidar), scan, residuals->log_likelihoods);
}

float logLikelihoodNearSurface(const MapView& map, double distance) {
  const double at_least_a_cell = std::max(distance, map.grid.geometry().resolution);
  return static_cast<float>(map.field.logLikelihoodAt(at_least_a_cell));
}

}  // namespace racecar_mcl
