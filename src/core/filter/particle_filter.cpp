#include "racecar_mcl/filter/particle_filter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "racecar_mcl/filter/convergence.h"
#include "racecar_mcl/filter/tempering.h"

namespace racecar_mcl {
namespace {

// Before convergence: minimum effective sample size after a scan, as a fraction of the set, since
// the best match of a single scan is often a wrong place (docs/decisions.md).
constexpr double kGlobalEffectiveRatio = 0.05;

// Minimum exponent of a scan for a converged set (docs/decisions.md).
constexpr double kMinConvergedDecorrelation = 0.1;

/// Exponent of a scan's likelihood by its inlier ratio: the largest log-likelihood ratio of a beam
/// for the outlier ratio observed, relative to that for the typical one (docs/maths.md).
double informationExponentOf(double inlier_ratio) {
  constexpr double kTypicalOutlierRatio = 0.1;  // as z_rand
  constexpr double kMaxOutlierRatio = 0.999;    // keeps the exponent above zero
  const double outlier_ratio =
      std::clamp(1.0 - inlier_ratio, kTypicalOutlierRatio, kMaxOutlierRatio);
  return std::log(outlier_ratio) / std::log(kTypicalOutlierRatio);
}

}  // namespace

ParticleFilter::ParticleFilter(const ParticleFilterParameters& parameters,
                               const MotionModelParameters& motion, std::uint64_t seed)
    : parameters_((validate(parameters), parameters)), motion_parameters_(motion), random_(seed) {
  validate(motion_parameters_);
}

void ParticleFilter::setParameters(const ParticleFilterParameters& parameters,
                                   const MotionModelParameters& motion) {
  validate(parameters);
  validate(motion);
  resize_is_due_ |= parameters.num_particles != parameters_.num_particles;
  parameters_ = parameters;
  motion_parameters_ = motion;
}

void ParticleFilter::predict(const Motion& motion) {
  for (std::optional<Motion>& moved : moved_) {
    const Motion before = moved.value_or(Motion{});
    moved = motion;
    moved->distance += before.distance;
    moved->rotation += before.rotation;
  }
  moveParticles(motion_parameters_, motion, random_, &particles_);
}

const UpdateResult& ParticleFilter::update(const Scan& scan, SensorModel* model, const MapView* map,
                                           double decorrelation_distance) {
  requireStart();
  std::optional<Motion>& moved = moved_.at(static_cast<std::size_t>(scan.lidar));
  double exponent = decorrelationExponent(moved, decorrelation_distance);
  moved.reset();
  if (converged_) ++converged_updates_;

  scan_likelihood_.evaluate(particles_, scan, model, &log_likelihoods_);
  if (map && converged_ && parameters_.bound_information) {
    exponent *= informationExponent(*map, scan);
  }
  scaleLogLikelihoods(exponent);
  result_.resampled = false;
  result_.log_likelihood = anneal(scan, model, exponent) + reweight();
  result_.weights_vanished = !std::isfinite(result_.log_likelihood);

  summarizeSet(static_cast<int>(scan.size()));
  if (!converged_) collapseToMode(result_.clusters);
  const double threshold = parameters_.resample_threshold * static_cast<double>(particles_.size());
  const bool is_due = result_.effective_sample_size <= threshold || resize_is_due_;
  if (is_due && !result_.weights_vanished) {
    resampleAndRegularize();
    resize_is_due_ = false;
    result_.resampled = true;
  }
  return result_;
}

double ParticleFilter::decorrelationExponent(const std::optional<Motion>& moved,
                                             double distance) const {
  if (!moved) return 1.0;
  if (!converged_) return decorrelationAfter(*moved, parameters_.scan_decorrelation_distance);
  // Just after convergence there is no earlier scan that this one could repeat.
  if (converged_updates_ < parameters_.regularization_updates) return 1.0;
  return std::max(kMinConvergedDecorrelation, decorrelationAfter(*moved, distance));
}

double ParticleFilter::informationExponent(const MapView& map, const Scan& scan) {
  Eigen::Index best = 0;
  log_likelihoods_.maxCoeff(&best);
  const ScanMatch match = match_evaluator_.evaluate(map, particles_.pose(best), scan);
  return informationExponentOf(match.inlier_ratio);
}

void ParticleFilter::scaleLogLikelihoods(double exponent) {
  if (exponent < 1.0) log_likelihoods_ *= exponent;
  if (converged_) return;
  const double effective = kGlobalEffectiveRatio * static_cast<double>(particles_.size());
  log_likelihoods_ *= temperingExponent(particles_.log_weight, log_likelihoods_, effective);
}

double ParticleFilter::reweight() {
  log_likelihoods_ += particles_.log_weight;
  const double log_likelihood = normalizeLogWeights(&log_likelihoods_, &weights_);
  if (std::isfinite(log_likelihood)) {
    particles_.log_weight.swap(log_likelihoods_);
  } else {
    weightsOf(particles_, &weights_);
  }
  return log_likelihood;
}

void ParticleFilter::summarizeSet(int beams) {
  result_.beams = beams;
  result_.particles = static_cast<int>(particles_.size());
  result_.effective_sample_size = effectiveSampleSize(weights_);
  // The maximum number, so that a larger number of clusters does not allocate.
  result_.clusters.reserve(static_cast<std::size_t>(particles_.size()));
  result_.clusters = cluster_finder_.find(particles_, weights_);
  result_.estimate = estimateFrom(result_.clusters);
}

void ParticleFilter::collapseToMode(const std::vector<Cluster>& clusters) {
  const std::optional<Pose2> place = singleCluster(clusters);
  if (!place) return;
  keepNear(*place, &particles_);
  weightsOf(particles_, &weights_);
  converged_ = true;
}

EstimateFrom ParticleFilter::estimateKind() const {
  // The mean of a multimodal set lies between its modes.
  const bool is_multimodal = !converged_ && parameters_.estimate == EstimateFrom::kMean;
  return is_multimodal ? EstimateFrom::kCluster : parameters_.estimate;
}

PoseEstimate ParticleFilter::estimateFrom(const std::vector<Cluster>& clusters) const {
  const Cluster& heaviest = clusters.front();
  const EstimateFrom kind = estimateKind();
  // The mean of a single cluster is that of the set.
  const bool mean_is_known = kind == EstimateFrom::kMean && heaviest.particles == particles_.size();
  if (kind == EstimateFrom::kCluster || mean_is_known) return heaviest.estimate;
  return estimatePose(particles_, weights_, kind);
}

PoseEstimate ParticleFilter::estimate() const {
  requireStart();
  return estimatePose(particles_, estimateKind());
}

void ParticleFilter::requireStart() const {
  if (!initialized()) {
    throw std::logic_error("the particle filter has no particles: initialize it first");
  }
}

}  // namespace racecar_mcl
