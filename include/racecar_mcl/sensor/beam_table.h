// Precomputed table of the beam model (report, section 2.2): p(z | d) of a measured range z given
// the expected range d.
#pragma once

#include <Eigen/Core>

namespace racecar_mcl {

struct BeamTableParameters {
  double alpha_hit = 0.74;    ///< weight of returns from mapped obstacles
  double alpha_short = 0.07;  ///< weight of returns from unmapped obstacles
  double alpha_max = 0.07;    ///< weight of beams without a return
  double alpha_rand = 0.12;   ///< weight of random returns
  double sigma_hit = 8.0;     ///< pixels, standard deviation of returns from mapped obstacles
  int table_width = 201;      ///< pixels 0 .. table_width - 1; the last one is the maximum range
};

/// Throws ParameterError if a weight is outside [0, 1], the weights do not sum to 1 (within 1e-3;
/// the table is normalised), all weights but alpha_short are zero, sigma_hit is not positive, or
/// the width is outside [2, 4001].
void validate(const BeamTableParameters& parameters);

/// T(z, d), table_width x table_width: row z is the measured and column d the expected range, in
/// pixels. Each column is the mixture
///
///   hit    N(z; d, sigma_hit), normalised over z
///   short  (2/d) (1 - z/d)  for z <= d, d != 0
///   max    1                for z = z_max
///   rand   1/z_max
///
/// normalised to sum to 1.
Eigen::ArrayXXd makeBeamTable(const BeamTableParameters& parameters);

}  // namespace racecar_mcl
