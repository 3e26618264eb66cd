// Normalising log weights, measuring their concentration, and drawing a new set.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/particles.h"
#include "racecar_mcl/pose_bins.h"
#include "racecar_mcl/random.h"

namespace racecar_mcl {

/// Shifts log weights so that the weights sum to 1 and returns the logarithm of their sum before;
/// `weights` receives them. Where all weights are zero (or one is NaN or +inf) it returns -inf,
/// leaves the log weights as they are, and what `weights` holds means nothing.
double normalizeLogWeights(Eigen::ArrayXd* log_weights, Eigen::ArrayXd* weights);
double normalizeLogWeights(Eigen::ArrayXd* log_weights);

/// The weights themselves. Into an array of the right size it allocates nothing.
Eigen::ArrayXd weightsOf(const ParticleSet& particles);
void weightsOf(const ParticleSet& particles, Eigen::ArrayXd* weights);

/// 1 / sum of squared weights: between 1 (one particle holds all) and N (all are equal). Needs
/// normalised weights.
double effectiveSampleSize(const Eigen::ArrayXd& weights);

enum class ResamplingMethod {
  kSystematic,   ///< one random number, N equally spaced pointers: the least variance
  kMultinomial,  ///< N independent draws
};

/// `count` particles drawn with probability equal to their weight, with uniform weights. Needs
/// normalised weights; throws std::invalid_argument on an empty set and where no weight is above
/// zero.
ParticleSet resample(const ParticleSet& particles, Eigen::Index count, ResamplingMethod method,
                     Random& random);

/// The same into a set that already has its size, with the weights at hand. The systematic method
/// allocates nothing.
void resample(const ParticleSet& particles, const Eigen::ArrayXd& weights, ResamplingMethod method,
              Random& random, ParticleSet* drawn);

/// The number of bins that hold at least one particle: how many places a set occupies.
Eigen::Index countOccupiedBins(const ParticleSet& particles, const PoseBins& bins);

/// Particles needed so that, with probability `confidence` given as a standard normal quantile, the
/// error of the histogram of `occupied_bins` bins stays under `error` (KLD sampling, Fox 2003, eq.
/// 7).
Eigen::Index kldSampleSize(Eigen::Index occupied_bins, double error = 0.05, double quantile = 2.33);

}  // namespace racecar_mcl
