// Weight normalisation, effective sample size, resampling and KLD sampling.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/geometry/pose_histogram.h"

namespace racecar_mcl {

/// Shifts log weights so that the weights sum to 1; `weights` receives the normalised weights.
/// Returns the logarithm of the sum before. If all weights are zero, or one is NaN or +inf, it
/// returns -inf and leaves the log weights unchanged; the content of `weights` is then undefined.
double normalizeLogWeights(Eigen::ArrayXd* log_weights, Eigen::ArrayXd* weights);
double normalizeLogWeights(Eigen::ArrayXd* log_weights);

/// exp(log weight) of each particle. Allocates nothing if the array has the right size.
Eigen::ArrayXd weightsOf(const ParticleSet& particles);
void weightsOf(const ParticleSet& particles, Eigen::ArrayXd* weights);

/// 1 / sum of squared weights: between 1 (one particle has all the weight) and N (equal weights).
/// Precondition: normalised weights.
double effectiveSampleSize(const Eigen::ArrayXd& weights);

enum class ResamplingMethod {
  kSystematic,   ///< one random number, N equally spaced pointers: low variance
  kMultinomial,  ///< N independent draws
};

/// `count` particles drawn with probability equal to their weight; the result has equal weights.
/// Precondition: normalised weights. Throws std::invalid_argument on an empty set and if no weight
/// is above zero.
ParticleSet resample(const ParticleSet& particles, Eigen::Index count, ResamplingMethod method,
                     Random& random);

/// The same into a set that already has its size, with the weights given. kSystematic allocates
/// nothing.
void resample(const ParticleSet& particles, const Eigen::ArrayXd& weights, ResamplingMethod method,
              Random& random, ParticleSet* drawn);

/// The number of bins that hold at least one particle.
Eigen::Index countOccupiedBins(const ParticleSet& particles, const PoseBins& bins);

/// KLD sampling (Fox 2003, eq. 7): the number of particles for which the Kullback-Leibler
/// divergence between the set and the posterior stays below `error` with the probability of the
/// standard normal `quantile` (2.33: 99 %), if the set occupies `occupied_bins` bins.
Eigen::Index kldSampleSize(Eigen::Index occupied_bins, double error = 0.05, double quantile = 2.33);

}  // namespace racecar_mcl
