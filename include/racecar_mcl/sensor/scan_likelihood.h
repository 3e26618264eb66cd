// Evaluates a sensor model at every particle.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/sensor_model.h"

namespace racecar_mcl {

/// Reuses its arrays: allocates only if a set is larger than all earlier ones.
class ScanLikelihood {
 public:
  /// Writes the log-likelihood of the scan for each particle (base in map) to `log_likelihoods`,
  /// which is resized.
  void evaluate(const ParticleSet& particles, const Scan& scan, SensorModel* model,
                Eigen::ArrayXd* log_likelihoods);

 private:
  Eigen::ArrayXd lidar_x_, lidar_y_, lidar_yaw_;  ///< in the map
};

}  // namespace racecar_mcl
