#include "racecar_mcl/relocalization/hypothesis_verifier.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "racecar_mcl/filter/convergence.h"
#include "racecar_mcl/relocalization/contradiction.h"

namespace racecar_mcl {
namespace {

// The factors were chosen on simulated drives and recordings (bench/2026-11-28-wrong-maps.md).

// Wald's lower bound, for a probability of 0.01 to reject the right place.
constexpr double kRejected = -4.6;

// Confirmation: log odds above which the alternative is accepted, and below which the first search
// restarts. Map errors can affect both searches, and a restart is cheap.
constexpr double kConfirmProven = 20.0;
constexpr double kConfirmRestart = -10.0;
// Scans until the search of other places has refined its poses. The last of them counts in full,
// since no scan has counted before it.
constexpr int kRefinementScans = 10;
// Maximum conflict with the map of a confirming scan: the car can have left the place since.
constexpr double kMaxConfirmConflict = 0.3;

// Challenge: Wald's upper bound, for a probability of 1e-6 to accept a wrong place.
constexpr double kChallengeProven = 13.8;
// Map errors are correlated over metres: driving distance between independent scans, for places far
// from the current pose and within it (docs/decisions.md).
constexpr double kDecorrelationDistance = 3.0;        // m
constexpr double kNearbyDecorrelationDistance = 1.0;  // m
// An alternative within these limits is the current pose.
constexpr double kSamePoseDistance = 0.15;  // m
constexpr double kSamePoseYaw = 0.08;       // rad
// A challenge without a decision ends after this distance driven.
constexpr double kMaxChallengeDistance = 15.0;  // m

// Prior: standard deviations added to the covariance of the current pose, and minimum log odds,
// those of places far away.
constexpr double kCarriedSigma = 0.5;     // m
constexpr double kCarriedYawSigma = 0.2;  // rad
constexpr double kFarPriorLogOdds = -10.0;

bool isSamePose(const Pose2& a, const Pose2& b) {
  return distance(a, b) <= kSamePoseDistance && std::abs(wrapAngle(a.yaw - b.yaw)) <= kSamePoseYaw;
}

/// The log odds of the alternative before any scan: Gaussian about the current pose, at least
/// `far_prior`.
double priorLogOdds(const Pose2& candidate, const PoseEstimate& carried, double far_prior) {
  const Pose2& pose = carried.base_in_map;
  const Eigen::Vector3d offset(candidate.x - pose.x, candidate.y - pose.y,
                               wrapAngle(candidate.yaw - pose.yaw));
  Eigen::Matrix3d covariance = carried.covariance;
  covariance.diagonal() +=
      Eigen::Vector3d(kCarriedSigma * kCarriedSigma, kCarriedSigma * kCarriedSigma,
                      kCarriedYawSigma * kCarriedYawSigma);
  return std::max(far_prior, -0.5 * offset.dot(covariance.ldlt().solve(offset)));
}

/// Whether the straight line between two poses crosses an obstacle of the map.
bool crossesObstacle(const OccupancyGrid& grid, const Pose2& from, const Pose2& to) {
  const int steps =
      static_cast<int>(std::ceil(2.0 * distance(from, to) / grid.geometry().resolution));
  for (int step = 1; step <= steps; ++step) {
    const Pose2 pose = interpolate(from, to, static_cast<double>(step) / steps);
    if (grid.at(cellAt(grid.geometry(), {pose.x, pose.y})) >= OccupancyGrid::kObstacleFrom) {
      return true;
    }
  }
  return false;
}

}  // namespace

HypothesisVerifier::HypothesisVerifier(const ParticleFilterParameters& parameters,
                                       const MotionModelParameters& motion, std::uint64_t seed)
    : filter_(parameters, motion, seed),
      num_threads_(parameters.num_threads),
      scan_decorrelation_distance_(parameters.scan_decorrelation_distance) {
  both_.resize(2);
}

void HypothesisVerifier::setParameters(const ParticleFilterParameters& parameters,
                                       const MotionModelParameters& motion) {
  filter_.setParameters(parameters, motion);
  num_threads_ = parameters.num_threads;
  scan_decorrelation_distance_ = parameters.scan_decorrelation_distance;
}

void HypothesisVerifier::startConfirmation(const SearchMap& map, const Scan& scan) {
  start(Purpose::kAgreement, map, scan, std::nullopt);
}

void HypothesisVerifier::startChallenge(const SearchMap& map, const Scan& scan,
                                        bool carried_is_confirmed) {
  start(Purpose::kChallenge, map, scan, std::nullopt);
  far_prior_log_odds_ = carried_is_confirmed ? kFarPriorLogOdds : 0.0;
}

void HypothesisVerifier::start(Purpose purpose, const SearchMap& map, const Scan& scan,
                               const std::optional<Pose2>& except) {
  filter_.initializeGlobally([&](Eigen::Index count, Random& random) {
    return map.matcher.candidates(scan, count, random, except);
  });
  purpose_ = purpose;
  candidate_.reset();
  log_odds_ = 0.0;
  scans_ = 0;
  travelled_ = 0.0;
  last_carried_.reset();
  crossed_obstacle_ = false;
}

HypothesisVerifier::Decision HypothesisVerifier::update(const Motion& motion, const SearchMap& map,
                                                        const Scan& scan,
                                                        const PoseEstimate& carried) {
  filter_.predict(motion);
  LikelihoodFieldModel coarse(map.matcher.field(), num_threads_);
  const UpdateResult& update =
      filter_.update(scan, filter_.converged() ? map.sensor_model : &coarse, &map.view);
  travelled_ += motion.distance;
  if (last_carried_) {
    crossed_obstacle_ =
        crossed_obstacle_ || crossesObstacle(map.view.grid, *last_carried_, carried.base_in_map);
  }
  last_carried_ = carried.base_in_map;
  const bool is_new = filter_.converged() && !candidate_;
  if (filter_.converged()) candidate_ = update.estimate;
  if (challenging()) return challenge(motion, map, scan, carried, is_new);
  return purpose_ == Purpose::kAgreement
             ? agree(motion, map, scan, carried.base_in_map)
             : ruleOut(motion, map, scan, carried.base_in_map, update.best_match, is_new);
}

HypothesisVerifier::Decision HypothesisVerifier::agree(const Motion& motion, const SearchMap& map,
                                                       const Scan& scan, const Pose2& carried) {
  if (!candidate_) return Decision::kUndecided;
  if (isSamePlace(candidate_->base_in_map, carried)) {
    start(Purpose::kOtherPlaces, map, scan, carried);
    return Decision::kUndecided;
  }
  addFieldEvidence(candidate_->base_in_map, carried, decorrelation(motion), map, scan);
  if (log_odds_ > kConfirmProven) return Decision::kProven;
  if (log_odds_ < kConfirmRestart) startConfirmation(map, scan);
  return Decision::kUndecided;
}

HypothesisVerifier::Decision HypothesisVerifier::ruleOut(const Motion& motion, const SearchMap& map,
                                                         const Scan& scan, const Pose2& carried,
                                                         const Pose2& best_match, bool is_new) {
  // The best match of each scan is a bound for all other places, and no evidence for one of them.
  if (is_new) log_odds_ = std::min(log_odds_, 0.0);
  if (++scans_ < kRefinementScans) return Decision::kUndecided;
  const double weight = scans_ == kRefinementScans ? 1.0 : decorrelation(motion);
  addFieldEvidence(candidate_ ? candidate_->base_in_map : best_match, carried, weight, map, scan);
  if (!candidate_ || !isSamePlace(candidate_->base_in_map, carried)) {
    if (candidate_ && log_odds_ > kConfirmProven) return Decision::kProven;
    if (log_odds_ > kRejected) return Decision::kUndecided;
  }
  if (match_evaluator_.evaluate(map.view, carried, scan).conflict() > kMaxConfirmConflict) {
    startConfirmation(map, scan);
    return Decision::kUndecided;
  }
  stop();
  return Decision::kConfirmed;
}

HypothesisVerifier::Decision HypothesisVerifier::challenge(const Motion& motion,
                                                           const SearchMap& map, const Scan& scan,
                                                           const PoseEstimate& carried,
                                                           bool is_new) {
  if (!candidate_) {
    return travelled_ > kMaxChallengeDistance ? reject() : Decision::kUndecided;
  }
  const Pose2& found = candidate_->base_in_map;
  if (isSamePose(found, carried.base_in_map)) {
    stop();
    return Decision::kConfirmed;
  }
  if (is_new) {
    log_odds_ = priorLogOdds(found, carried, far_prior_log_odds_);
    return Decision::kUndecided;
  }
  const double distance = isSamePlace(found, carried.base_in_map) ? kNearbyDecorrelationDistance
                                                                  : kDecorrelationDistance;
  log_odds_ += decorrelationAfter(motion, distance) *
               contradictionLogOdds(map.view, found, carried.base_in_map, scan, crossed_obstacle_);
  if (log_odds_ >= kChallengeProven) return Decision::kProven;
  const bool goes_on =
      log_odds_ > far_prior_log_odds_ + kRejected && travelled_ <= kMaxChallengeDistance;
  return goes_on ? Decision::kUndecided : reject();
}

HypothesisVerifier::Decision HypothesisVerifier::reject() {
  stop();
  return Decision::kRejected;
}

double HypothesisVerifier::decorrelation(const Motion& motion) const {
  return decorrelationAfter(motion, scan_decorrelation_distance_);
}

void HypothesisVerifier::addFieldEvidence(const Pose2& other, const Pose2& carried, double weight,
                                          const SearchMap& map, const Scan& scan) {
  both_.setPose(0, other);
  both_.setPose(1, carried);
  LikelihoodFieldModel coarse(map.matcher.field());
  scan_likelihood_.evaluate(both_, scan, &coarse, &log_likelihoods_);
  log_odds_ += weight * (log_likelihoods_[0] - log_likelihoods_[1]);
}

}  // namespace racecar_mcl
