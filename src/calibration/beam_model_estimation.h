// Maximum-likelihood estimation of the beam model's parameters from beams with known expected
// ranges.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/sensor/beam_model.h"

namespace racecar_mcl {

/// Histogram of measured ranges z against expected ranges d, in pixels.
class RangeCounts {
 public:
  /// Pixels as in BeamModel; `resolution`: metres per map cell. Throws as BeamModel.
  RangeCounts(const BeamModelParameters& parameters, double resolution);

  /// Adds K measured and K expected ranges, m; +inf is the table's last pixel.
  void add(const Eigen::ArrayXf& measured, const Eigen::ArrayXf& expected);

  /// counts()(z, d), of the table's size.
  const Eigen::ArrayXXd& counts() const { return counts_; }
  double total() const { return counts_.sum(); }
  double maxRange() const { return static_cast<double>(counts_.rows() - 1) * pixel_; }
  double pixel() const { return pixel_; }  ///< m

 private:
  Eigen::ArrayXXd counts_;
  double pixel_;
};

struct BeamModelEstimate {
  BeamTableParameters table;
  int iterations = 0;
  double log_likelihood_before = 0.0;  ///< mean per beam, with the initial parameters
  double log_likelihood = 0.0;         ///< mean per beam
};

/// Mean log T(z, d) over the counted beams.
double meanLogLikelihood(const Eigen::ArrayXXd& counts, const BeamTableParameters& table);

/// The maximum-likelihood mixture weights and sigma_hit of the counted beams, by expectation
/// maximisation from the given parameters (weights of 0 start at 0.01); table_width is kept. Throws
/// std::invalid_argument if the counts do not have the table's size or are empty.
BeamModelEstimate estimateBeamModel(const Eigen::ArrayXXd& counts,
                                    const BeamTableParameters& start);

}  // namespace racecar_mcl
