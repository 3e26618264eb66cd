// Beam model of a range finder (Probabilistic Robotics, section 6.3) with a precomputed table: log-
// likelihoods of measured ranges given expected ranges.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/sensor/beam_table.h"

namespace racecar_mcl {

struct BeamModelParameters {
  BeamTableParameters table;
  double lidar_scale_to_map_scale = 1.0;      ///< pixel size / cell size (report, section 2.2)
  double pixels_per_cell = 1.0;               ///< table pixels per map cell
  double likelihood_exponent = 37.0 / 240.0;  ///< of the product over the beams, in (0, 1], since
                                              ///< errors of neighbouring beams are correlated
};

/// Throws ParameterError on a scale or an exponent outside [0.001, 1000], and as the table does.
void validate(const BeamModelParameters& parameters);

/// The range of the last pixel of the beam table, m. `resolution`: m per map cell.
double beamTableRange(const BeamModelParameters& parameters, double resolution);

/// Independent of the map: only compares ranges.
class BeamModel {
 public:
  /// `resolution`: m per map cell. Throws as `validate`, and ParameterError if it is not positive.
  BeamModel(const BeamModelParameters& parameters, double resolution);

  /// As beamTableRange. Longer ranges, +inf included, are clamped to it.
  double maxRange() const { return static_cast<double>(width_ - 1) * pixel_; }

  /// The log-likelihood of one scan for each of N particles.
  /// `measured`: K ranges, m (+inf = no return); `expected`: K x N ranges, m; `log_likelihood`: N
  /// values.
  void logLikelihood(const Eigen::ArrayXf& measured,
                     const Eigen::Ref<const Eigen::ArrayXXf>& expected,
                     Eigen::Ref<Eigen::ArrayXd> log_likelihood) const;

 private:
  int width_;
  double pixel_;  ///< m
  double exponent_;
  /// log T transposed: column z holds d = 0 .. width - 1, which one measured beam reads.
  Eigen::ArrayXXf log_table_;
};

}  // namespace racecar_mcl
