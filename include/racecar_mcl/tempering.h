// How much of a scan to believe while the particles are in many places.
#pragma once

#include <Eigen/Core>

namespace racecar_mcl {

/// The largest exponent in (0, 1] that leaves an effective sample size of at least `wanted` when
/// weights are multiplied by likelihoods to that power. 1 where the scan itself leaves as much,
/// where the weights before have less already, and where a likelihood is zero or not a number. Log
/// weights need not be normalised.
double temperingExponent(const Eigen::ArrayXd& log_weights, const Eigen::ArrayXd& log_likelihoods,
                         double wanted);

}  // namespace racecar_mcl
