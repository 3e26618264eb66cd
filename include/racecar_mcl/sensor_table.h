// The precomputed sensor table (report, section 2.2): how likely a range z is where d is expected.
#pragma once

#include <Eigen/Core>

namespace racecar_mcl {

struct SensorTableParameters {
  double alpha_hit = 0.74;    ///< share of beams that return from what the map shows
  double alpha_short = 0.07;  ///< share stopped early by something unmapped
  double alpha_max = 0.07;    ///< share without a return
  double alpha_rand = 0.12;   ///< share of noise
  double sigma_hit = 8.0;     ///< pixels, spread of a hit about the expected range
  int table_width = 201;      ///< pixels 0 .. table_width - 1; the last one is the maximum range
};

/// Throws ParameterError on a negative or non-finite share, shares that do not sum to 1 (within
/// 1e-3; below they are normalised anyway), alpha_short alone, a sigma that is not positive, or a
/// width outside [2, 4001].
void validate(const SensorTableParameters& parameters);

/// T(z, d), table_width x table_width: row z is the measured and column d the expected range, in
/// pixels. Each column is the mix
///
///   hit    N(z; d, sigma_hit), normalised over z
///   short  (2/d) (1 - z/d)  for z <= d, d != 0
///   max    1                for z = z_max
///   rand   1/z_max
///
/// normalised to sum to 1.
Eigen::ArrayXXd makeSensorTable(const SensorTableParameters& parameters);

}  // namespace racecar_mcl
