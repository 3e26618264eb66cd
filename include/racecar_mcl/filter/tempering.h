// Tempering: likelihood exponents that bound the loss of effective particles.
#pragma once

#include <Eigen/Core>

namespace racecar_mcl {

/// The effective sample size of weight * likelihood^exponent; NaN if a log-likelihood is NaN or
/// +infinite; a likelihood of zero is a weight of zero.
double temperedSampleSize(const Eigen::ArrayXd& log_weights, double exponent,
                          const Eigen::ArrayXd& log_likelihoods);

/// The largest exponent in (0, 1] for which weight * likelihood^exponent has an effective sample
/// size of at least `wanted`. Returns 1 if the full likelihood leaves as much, if the weights alone
/// have less already, or if a likelihood is zero or not finite. Log weights need not be
/// normalised.
double temperingExponent(const Eigen::ArrayXd& log_weights, const Eigen::ArrayXd& log_likelihoods,
                         double wanted);

}  // namespace racecar_mcl
