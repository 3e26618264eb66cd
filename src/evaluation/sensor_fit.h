// The constants of the sensor table, learned from beams whose expected ranges are known.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/beam_model.h"

namespace racecar_mcl {

/// How often a range of z pixels was measured where d pixels were expected.
class RangeCounts {
 public:
  /// Pixels as BeamModel has them; `resolution`: metres per map cell. Throws as BeamModel.
  RangeCounts(const BeamModelParameters& parameters, double resolution);

  /// K measured and K expected ranges, m; +inf counts as the table's last pixel.
  void add(const Eigen::ArrayXf& measured, const Eigen::ArrayXf& expected);

  /// counts()(z, d), as large as the table.
  const Eigen::ArrayXXd& counts() const { return counts_; }
  double total() const { return counts_.sum(); }
  double maxRange() const { return static_cast<double>(counts_.rows() - 1) * pixel_; }
  double pixel() const { return pixel_; }  ///< m

 private:
  Eigen::ArrayXXd counts_;
  double pixel_;
};

struct SensorFit {
  SensorTableParameters table;
  int iterations = 0;
  double log_likelihood_before = 0.0;  ///< mean per beam, with the constants at the start
  double log_likelihood = 0.0;         ///< mean per beam
};

/// Mean log T(z, d) over the counted beams.
double meanLogLikelihood(const Eigen::ArrayXXd& counts, const SensorTableParameters& table);

/// The shares and sigma_hit under which the counted beams are most likely, by expectation
/// maximisation from the given constants; shares that are zero are tried, too. table_width stays.
/// Throws std::invalid_argument where the counts are not as large as the table or hold no beam.
SensorFit fitSensorTable(const Eigen::ArrayXXd& counts, const SensorTableParameters& start);

}  // namespace racecar_mcl
