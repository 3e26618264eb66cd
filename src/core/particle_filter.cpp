#include "racecar_mcl/particle_filter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "racecar_mcl/convergence.h"
#include "racecar_mcl/errors.h"
#include "racecar_mcl/require.h"
#include "racecar_mcl/scan_fit.h"
#include "racecar_mcl/tempering.h"
#include "smoothing.h"

namespace racecar_mcl {
namespace {

// While the set converges, a scan leaves at least this share of it alive: the place that fits best
// at first sight is often the wrong one.
constexpr double kConvergingSurvivors = 0.05;
// The set shrinks to one particle in so many of global_particles before it has settled.
constexpr Eigen::Index kConvergingShare = 10;

// A scan is weighed in at most so many steps, each of which leaves at most this share of the set.
// Between them, copies are spread by a kernel of this share of the set's own sigma.
constexpr int kMostSteps = 4;
constexpr double kMostEffective = 0.5;
constexpr double kStepKernel = 0.3;

// However little the car has moved, a scan of a settled set counts by this share.
constexpr double kLeastNews = 0.1;

/// The information that is left in a scan of which the map explains this share: the largest
/// log-likelihood ratio of a beam whose share of unexplained beams is not field_rand but what was
/// seen.
double informationOf(double explained) {
  constexpr double kUnexplainedOfGoodMaps = 0.1;
  const double unexplained = std::clamp(1.0 - explained, kUnexplainedOfGoodMaps, 0.999);
  return std::log(unexplained) / std::log(kUnexplainedOfGoodMaps);
}

// No start is farther away or wider than this, m: beyond it, squares lose their digits.
constexpr double kFarthest = 1e7;

Eigen::Matrix3d startCovariance(const PoseEstimate& start, double sigma) {
  Eigen::Matrix3d covariance = 0.5 * (start.covariance + start.covariance.transpose());
  for (int i = 0; i < 3; ++i) {
    if (covariance(i, i) == 0.0) {
      covariance.row(i).setZero();
      covariance.col(i).setZero();
      covariance(i, i) = sigma * sigma;
    }
  }
  return covariance;
}

}  // namespace

void validate(const ParticleFilterParameters& p) {
  constexpr int kMost = 10000000;
  requireWithin("num_particles", p.num_particles, 1, kMost);
  require(p.global_particles >= p.num_particles && p.global_particles <= kMost, "global_particles",
          p.global_particles, "between num_particles and " + std::to_string(kMost));
  requireShare("resample_threshold", p.resample_threshold);
  requireNotNegative("min_effective_particles", p.min_effective_particles);
  requirePositiveUpTo("initial_sigma", p.initial_sigma, 1000.0);
  requirePositiveUpTo("news_distance", p.news_distance, 1000.0, "m");
  requireNotNegative("settling_updates", p.settling_updates);
  requireWithin("num_threads", p.num_threads, 0, 1024);
}

ParticleFilter::ParticleFilter(const ParticleFilterParameters& parameters,
                               const MotionModelParameters& motion, std::uint64_t seed)
    : parameters_((validate(parameters), parameters)),
      motion_parameters_(motion),
      random_(seed),
      weigher_(parameters.num_threads) {
  validate(motion_parameters_);
}

void ParticleFilter::initialize(const PoseEstimate& start) {
  if (!isFinite(start.base_in_map) || !start.covariance.allFinite()) {
    throw ParameterError("the start pose and its covariance must be finite");
  }
  const double farthest = std::max(std::abs(start.base_in_map.x), std::abs(start.base_in_map.y));
  const double widest = std::sqrt(std::max(0.0, start.covariance.diagonal().maxCoeff()));
  if (farthest > kFarthest || widest > kFarthest) {
    std::ostringstream problem;
    problem << "the start pose lies " << farthest << " m from the map's zero with a sigma of "
            << widest << "; expected at most " << kFarthest;
    throw ParameterError(problem.str());
  }
  const Eigen::Matrix3d root = rootOf(startCovariance(start, parameters_.initial_sigma));
  ParticleSet particles;
  particles.resize(parameters_.num_particles);
  particles.x.setConstant(start.base_in_map.x);
  particles.y.setConstant(start.base_in_map.y);
  particles.yaw.setConstant(start.base_in_map.yaw);
  spread(root, random_, &particles);
  startFrom(std::move(particles), false);
}

void ParticleFilter::startFrom(ParticleSet particles, bool converging) {
  particles_ = std::move(particles);
  particles_.log_weight.setConstant(-std::log(static_cast<double>(particles_.size())));
  settling_updates_left_ = parameters_.settling_updates;
  settled_updates_ = 0;
  converging_ = converging;
}

void ParticleFilter::initializeGlobally(const MapModel& map) {
  ParticleSet particles;
  particles.resize(parameters_.global_particles);
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    const Cell& cell = map.free_cells[random_.index(map.free_cells.size())];
    const double across = random_.uniform();
    const double up = random_.uniform();
    const Eigen::Vector2d point =
        gridToWorld(map.grid.geometry(), {cell.column + across, cell.row + up});
    particles.setPose(i, {point.x(), point.y(), random_.uniform(-kPi, kPi)});
  }
  startFrom(std::move(particles), true);
}

const UpdateResult& ParticleFilter::initializeGlobally(const MapModel& map, const Scan& beams) {
  startFrom(map.search.candidates(beams, parameters_.global_particles, random_), true);
  return reportStart(beams);
}

const UpdateResult& ParticleFilter::initialize(const ParticleSet& particles, const Scan& beams) {
  startFrom(particles, false);
  return reportStart(beams);
}

const UpdateResult& ParticleFilter::reportStart(const Scan& beams) {
  weightsOf(particles_, &weights_);
  result_ = UpdateResult{};
  reportSet(beams);
  return result_;
}

void ParticleFilter::predict(const Motion& motion) {
  const Motion before = moved_.value_or(Motion{});
  moved_ = motion;
  moved_->distance += before.distance;
  moved_->rotation += before.rotation;
  moveParticles(motion_parameters_, motion, random_, &particles_);
}

const UpdateResult& ParticleFilter::update(MapModel* map, const Scan& beams,
                                           double repeat_distance) {
  requireStart();
  news_ = news(repeat_distance);
  const auto weigh = [&](const ParticleSet& particles) -> Eigen::ArrayXd& {
    return converging_ ? weigher_.weigh(map->search.field(), particles, beams)
                       : weigher_.weigh(map, particles, beams);
  };
  Eigen::ArrayXd& log_likelihoods = weigh(particles_);
  if (!converging_ && parameters_.bound_information) {
    news_ *= mappedInformation(map, beams, log_likelihoods);
  }
  return updateBy(weigh, log_likelihoods, beams);
}

const UpdateResult& ParticleFilter::update(const LikelihoodField& field, const Scan& beams) {
  requireStart();
  news_ = 1.0;
  const auto weigh = [&](const ParticleSet& particles) -> Eigen::ArrayXd& {
    return weigher_.weigh(field, particles, beams);
  };
  return updateBy(weigh, weigh(particles_), beams);
}

double ParticleFilter::mappedInformation(MapModel* map, const Scan& beams,
                                         const Eigen::ArrayXd& log_likelihoods) {
  Eigen::Index best = 0;
  log_likelihoods.maxCoeff(&best);
  return informationOf(matcher_.fit(map, particles_.pose(best), beams).explained);
}

template <typename Weigh>
const UpdateResult& ParticleFilter::updateBy(const Weigh& weigh, Eigen::ArrayXd& log_weights,
                                             const Scan& beams) {
  moved_.reset();
  if (!converging_) ++settled_updates_;
  result_.resampled = false;
  scaleToNews(&log_weights);
  const double log_likelihood_of_steps = anneal(weigh, &log_weights, &result_.resampled);
  log_weights += particles_.log_weight;
  result_.log_likelihood = log_likelihood_of_steps + normalizeLogWeights(&log_weights, &weights_);
  result_.weights_vanished = !std::isfinite(result_.log_likelihood);
  if (result_.weights_vanished) {
    weightsOf(particles_, &weights_);
  } else {
    particles_.log_weight.swap(log_weights);
  }

  reportSet(beams);
  if (converging_) settleOn(result_.clusters);
  const double threshold = parameters_.resample_threshold * static_cast<double>(particles_.size());
  if (result_.effective_sample_size <= threshold && !result_.weights_vanished) {
    resampleAndSettle();
    result_.resampled = true;
  }
  return result_;
}

void ParticleFilter::reportSet(const Scan& beams) {
  result_.beams = static_cast<int>(beams.size());
  result_.particles = static_cast<int>(particles_.size());
  result_.effective_sample_size = effectiveSampleSize(weights_);
  result_.converging = converging_;
  // As many as there can be: more places than ever before cost no memory either.
  result_.clusters.reserve(static_cast<std::size_t>(particles_.size()));
  result_.clusters = cluster_finder_.find(particles_, weights_);
  result_.estimate = estimateFrom(result_.clusters);
}

double ParticleFilter::news(double repeat_distance) const {
  if (!moved_) return 1.0;
  if (converging_) return newsAfter(*moved_, parameters_.news_distance);
  // Of a place that was just found little is known that a scan could repeat.
  if (settled_updates_ < parameters_.settling_updates) return 1.0;
  return std::max(kLeastNews, newsAfter(*moved_, repeat_distance));
}

void ParticleFilter::scaleToNews(Eigen::ArrayXd* log_likelihoods) const {
  if (news_ < 1.0) *log_likelihoods *= news_;
  if (!converging_) return;
  const double survivors = kConvergingSurvivors * static_cast<double>(particles_.size());
  *log_likelihoods *= temperingExponent(particles_.log_weight, *log_likelihoods, survivors);
}

template <typename Weigh>
double ParticleFilter::anneal(const Weigh& weigh, Eigen::ArrayXd* log_likelihoods,
                              bool* resampled) {
  const double wanted = std::min<double>(parameters_.min_effective_particles,
                                         kMostEffective * static_cast<double>(particles_.size()));
  if (wanted <= 0.0 || converging_ || motion_parameters_.deterministic) return 0.0;
  double log_likelihood = 0.0;
  double left = 1.0;  // of the scan
  for (int step = 1; step < kMostSteps; ++step) {
    const double part = temperingExponent(particles_.log_weight, *log_likelihoods, wanted);
    if (part == 1.0) break;
    particles_.log_weight += part * *log_likelihoods;
    log_likelihood += normalizeLogWeights(&particles_.log_weight, &weights_);
    const PoseEstimate shape = weightedMean(particles_, weights_);
    drawn_.resize(particles_.size());
    resample(particles_, weights_, parameters_.resampling, random_, &drawn_);
    std::swap(particles_, drawn_);
    *resampled = true;
    // Copies part, and the set keeps its mean and covariance (Liu and West 2001).
    drawTogether(shape.base_in_map, 1.0 - std::sqrt(1.0 - kStepKernel * kStepKernel), &particles_);
    spread(kStepKernel * rootOf(shape.covariance), random_, &particles_);
    left *= 1.0 - part;
    scaleToNews(&weigh(particles_));
    *log_likelihoods *= left;
  }
  return log_likelihood;
}

void ParticleFilter::settleOn(const std::vector<Cluster>& clusters) {
  const std::optional<Pose2> place = onlyPlace(clusters);
  if (!place) return;
  keepNear(*place, &particles_);
  weightsOf(particles_, &weights_);
  converging_ = false;
}

EstimateFrom ParticleFilter::kindOfEstimate() const {
  // The mean of several places is none of them.
  const bool between_places = converging_ && parameters_.estimate == EstimateFrom::kMean;
  return between_places ? EstimateFrom::kCluster : parameters_.estimate;
}

PoseEstimate ParticleFilter::estimateFrom(const std::vector<Cluster>& clusters) const {
  const Cluster& heaviest = clusters.front();
  const EstimateFrom kind = kindOfEstimate();
  // Of a set in one place, that place's mean is the set's.
  const bool mean_is_known = kind == EstimateFrom::kMean && heaviest.particles == particles_.size();
  if (kind == EstimateFrom::kCluster || mean_is_known) return heaviest.estimate;
  return estimatePose(particles_, weights_, kind);
}

PoseEstimate ParticleFilter::estimate() const {
  requireStart();
  return estimatePose(particles_, kindOfEstimate());
}

void ParticleFilter::requireStart() const {
  if (!initialized())
    throw std::logic_error("the particle filter has no particles: start it first");
}

Eigen::Index ParticleFilter::nextSize() const {
  if (particles_.size() <= parameters_.num_particles) return parameters_.num_particles;
  // Finer bins than a cluster's: the set shrinks no faster than the scans tell its places apart.
  const Eigen::Index wanted = kldSampleSize(countOccupiedBins(particles_, {0.25, 0.17}));
  const Eigen::Index least = converging_ ? parameters_.global_particles / kConvergingShare : 0;
  return std::min(particles_.size(),
                  std::max<Eigen::Index>({parameters_.num_particles, wanted, least}));
}

void ParticleFilter::resampleAndSettle() {
  drawn_.resize(particles_.size());
  resample(particles_, weights_, parameters_.resampling, random_, &drawn_);
  std::swap(particles_, drawn_);
  const Eigen::Index size = nextSize();
  if (size < particles_.size()) {
    particles_ = resample(drawn_, size, parameters_.resampling, random_);
  }
  if (settling_updates_left_ == 0) return;
  --settling_updates_left_;

  // The kernel's width after Silverman, for three dimensions.
  const double bandwidth = 0.5 * std::pow(static_cast<double>(particles_.size()), -1.0 / 7.0);
  weightsOf(particles_, &weights_);
  const Cluster& heaviest = cluster_finder_.find(particles_, weights_).front();
  spread(bandwidth * rootOf(heaviest.estimate.covariance), random_, &particles_);
}

}  // namespace racecar_mcl
