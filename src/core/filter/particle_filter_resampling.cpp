// Resampling steps of the particle filter: annealing, KLD sampling and kernel regularization.
#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/kernel_regularization.h"
#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/filter/tempering.h"

namespace racecar_mcl {
namespace {

// Before convergence a set has at least max_particles divided by this.
constexpr Eigen::Index kGlobalSizeDivisor = 10;
// KLD sampling's bins: smaller than those of the clusters, so that the set does not shrink faster
// than scans separate its clusters.
constexpr PoseBins kKldBins{0.25, 0.17};  // m, rad

// Annealing (docs/maths.md): maximum number of steps, effective sample size after a step as a
// multiple of the minimum, its maxima as fractions of the set and of that before the step, and
// kernel width h of Liu and West (2001) as a fraction of the set's sigma.
constexpr int kMaxAnnealingSteps = 4;
constexpr double kStepRatio = 2.0;
constexpr double kMaxEffectiveRatio = 0.5;
constexpr double kMaxStepRatio = 0.9;
constexpr double kAnnealingKernel = 0.3;

// Bandwidth of the regularization kernel after Silverman (1986): factor, and exponent -1 / (d + 4)
// for d = 3 dimensions.
constexpr double kBandwidthFactor = 0.5;
constexpr double kBandwidthExponent = -1.0 / 7.0;

}  // namespace

double ParticleFilter::anneal(const Scan& scan, SensorModel* model, double exponent) {
  const double wanted =
      std::min<double>(kStepRatio * parameters_.min_effective_particles,
                       kMaxEffectiveRatio * static_cast<double>(particles_.size()));
  if (wanted <= 0.0 || !converged_ || motion_parameters_.deterministic) return 0.0;
  double log_likelihood = 0.0;
  double remaining = 1.0;  // exponent
  for (int step = 1; step < kMaxAnnealingSteps; ++step) {
    const auto effective = [this](double power) {
      return temperedSampleSize(particles_.log_weight, power, log_likelihoods_);
    };
    if (!(effective(1.0) < wanted / kStepRatio)) break;
    const double part = temperingExponent(particles_.log_weight, log_likelihoods_,
                                          std::min(wanted, kMaxStepRatio * effective(0.0)));
    if (part == 1.0) break;
    particles_.log_weight += part * log_likelihoods_;
    log_likelihood += normalizeLogWeights(&particles_.log_weight, &weights_);
    const PoseEstimate shape = weightedMean(particles_, weights_);
    drawn_.resize(particles_.size());
    resample(particles_, weights_, parameters_.resampling, random_, &drawn_);
    std::swap(particles_, drawn_);
    result_.resampled = true;
    // Jitter with shrinkage preserves the mean and covariance of the set (Liu and West 2001).
    shrinkTowardsMean(shape.base_in_map, 1.0 - std::sqrt(1.0 - kAnnealingKernel * kAnnealingKernel),
                      &particles_);
    jitter(kAnnealingKernel * matrixSqrt(shape.covariance), random_, &particles_);
    remaining *= 1.0 - part;
    scan_likelihood_.evaluate(particles_, scan, model, &log_likelihoods_);
    scaleLogLikelihoods(exponent);
    log_likelihoods_ *= remaining;
  }
  return log_likelihood;
}

Eigen::Index ParticleFilter::nextSize() const {
  if (particles_.size() <= parameters_.num_particles) return parameters_.num_particles;
  const Eigen::Index wanted = kldSampleSize(countOccupiedBins(particles_, kKldBins));
  const Eigen::Index minimum = converged_ ? 0 : parameters_.max_particles / kGlobalSizeDivisor;
  return std::min(particles_.size(),
                  std::max<Eigen::Index>({parameters_.num_particles, wanted, minimum}));
}

void ParticleFilter::resampleAndRegularize() {
  drawn_.resize(particles_.size());
  resample(particles_, weights_, parameters_.resampling, random_, &drawn_);
  std::swap(particles_, drawn_);
  const Eigen::Index size = nextSize();
  if (size < particles_.size() || resize_is_due_) {
    particles_ = resample(drawn_, size, parameters_.resampling, random_);
  }
  if (regularization_updates_left_ == 0) return;
  --regularization_updates_left_;

  const double bandwidth =
      kBandwidthFactor * std::pow(static_cast<double>(particles_.size()), kBandwidthExponent);
  weightsOf(particles_, &weights_);
  const Cluster& heaviest = cluster_finder_.find(particles_, weights_).front();
  jitter(bandwidth * matrixSqrt(heaviest.estimate.covariance), random_, &particles_);
}

}  // namespace racecar_mcl
