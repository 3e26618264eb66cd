// Weighs particles: measured ranges against the ranges expected from each particle, through the
// sensor table.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/sensor_table.h"

namespace racecar_mcl {

struct BeamModelParameters {
  SensorTableParameters table;
  double lidar_scale_to_map_scale = 1.0;  ///< a pixel is resolution x this, m (report, section 2.2)
  double pixels_per_cell = 1.0;           ///< finer pixels than the map's cells
  double squash_factor =
      2.2;  ///< a particle's weight is the product of its beams to the power 1 / this
};

/// Throws ParameterError on a scale or squash factor outside [0.001, 1000], and as the table does.
void validate(const BeamModelParameters& parameters);

/// Knows no map: only ranges.
class BeamModel {
 public:
  /// `resolution`: metres per map cell. Throws as `validate`, and where that is not positive.
  BeamModel(const BeamModelParameters& parameters, double resolution);

  /// The range of the table's last pixel, m. Longer ranges, +inf too, count as this.
  double maxRange() const { return static_cast<double>(width_ - 1) * pixel_; }

  /// The log-likelihood of one scan for each of N particles, squashed.
  /// `measured`: K ranges, m (+inf = no return); `expected`: K x N ranges, m; `log_likelihood`: N
  /// values.
  void logLikelihood(const Eigen::ArrayXf& measured,
                     const Eigen::Ref<const Eigen::ArrayXXf>& expected,
                     Eigen::Ref<Eigen::ArrayXd> log_likelihood) const;

 private:
  int width_;
  double pixel_;  ///< m
  double squash_;
  /// log T transposed: column z holds d = 0 .. width - 1 side by side, as one beam reads them.
  Eigen::ArrayXXf log_table_;
};

}  // namespace racecar_mcl
