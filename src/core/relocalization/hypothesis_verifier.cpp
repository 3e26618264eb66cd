#include "racecar_mcl/relocalization/hypothesis_verifier.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "racecar_mcl/filter/convergence.h"

namespace racecar_mcl {
namespace {

// The factors were chosen on simulated drives and recordings (bench/2026-11-28-wrong-maps.md).

// Confirmation: log odds above which the alternative is accepted, and below which the search
// restarts. Map errors can affect both searches, and a restart is cheap.
constexpr double kConfirmProven = 20.0;
constexpr double kConfirmRestart = -10.0;
// Maximum conflict with the map of a confirming scan: both searches can agree on a place that the
// car has left since.
constexpr double kMaxConfirmConflict = 0.3;

// Challenge: Wald's bounds for a probability of 1e-6 to accept a wrong place and of 0.01 to reject
// the right one.
constexpr double kChallengeProven = 13.8;
constexpr double kChallengeRejected = -4.6;
// Map errors are correlated over metres: driving distance between independent scans, for places far
// from the current pose and within it (docs/decisions.md).
constexpr double kDecorrelationDistance = 3.0;        // m
constexpr double kNearbyDecorrelationDistance = 1.0;  // m
// An alternative within these limits is the current pose.
constexpr double kSamePoseDistance = 0.15;  // m
constexpr double kSamePoseYaw = 0.08;       // rad
// A challenge without a decision ends after this distance driven.
constexpr double kMaxChallengeDistance = 15.0;  // m

// Log likelihoods of beams, relative to a matched one.
constexpr double kShortLogLikelihood = -1.0;
constexpr double kThroughLogLikelihood = -2.0;
constexpr double kUnmappedLogLikelihood = -1.0;
// Neighbouring beams have correlated errors: this number of beams counts as one.
constexpr double kBeamsPerObservation = 6.5;

// Prior: standard deviations added to the covariance of the current pose, and minimum log odds,
// those of places far away.
constexpr double kCarriedSigma = 0.5;     // m
constexpr double kCarriedYawSigma = 0.2;  // rad
constexpr double kFarPriorLogOdds = -10.0;

/// The log likelihood of a beam; `unmapped`: that of beams that end in unknown cells.
double logLikelihood(BeamMatch match, double unmapped) {
  switch (match) {
    case BeamMatch::kShort:
      return kShortLogLikelihood;
    case BeamMatch::kThrough:
      return kThroughLogLikelihood;
    case BeamMatch::kUnmapped:
      return unmapped;
    default:
      return 0.0;
  }
}

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

double contradictionLogOdds(const MapView& map, const Pose2& candidate, const Pose2& carried,
                            const Scan& beams, bool unmapped_counts) {
  ScanMatchEvaluator at_candidate, at_carried;
  const std::vector<BeamMatch>& there = at_candidate.classifyBeams(map, candidate, beams);
  const std::vector<BeamMatch>& here = at_carried.classifyBeams(map, carried, beams);
  double log_odds = 0.0;
  for (std::size_t k = 0; k < here.size(); ++k) {
    log_odds += logLikelihood(there[k], kUnmappedLogLikelihood) -
                logLikelihood(here[k], unmapped_counts ? kUnmappedLogLikelihood : 0.0);
  }
  return log_odds / kBeamsPerObservation;
}

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

void HypothesisVerifier::start(Purpose purpose, const SearchMap& map, const Scan& scan,
                               bool carried_is_confirmed) {
  filter_.initializeGlobally([&](Eigen::Index count, Random& random) {
    return map.matcher.candidates(scan, count, random);
  });
  purpose_ = purpose;
  far_prior_log_odds_ = carried_is_confirmed ? kFarPriorLogOdds : 0.0;
  candidate_.reset();
  log_odds_ = 0.0;
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
  if (!filter_.converged()) {
    if (challenging() && travelled_ > kMaxChallengeDistance) {
      stop();
      return Decision::kRejected;
    }
    return Decision::kUndecided;
  }
  const bool is_new = !candidate_;
  candidate_ = update.estimate;
  const Pose2& found = candidate_->base_in_map;
  const bool agrees = confirming() ? isSamePlace(found, carried.base_in_map)
                                   : isSamePose(found, carried.base_in_map);
  if (agrees) return onAgreement(map, scan);
  if (confirming()) return confirm(motion, map, scan, carried.base_in_map);
  if (is_new) {
    log_odds_ = priorLogOdds(found, carried, far_prior_log_odds_);
    return Decision::kUndecided;
  }
  return challenge(motion, map, scan, carried);
}

HypothesisVerifier::Decision HypothesisVerifier::onAgreement(const SearchMap& map,
                                                             const Scan& scan) {
  if (confirming() &&
      match_evaluator_.evaluate(map.view, candidate_->base_in_map, scan).conflict() >
          kMaxConfirmConflict) {
    start(Purpose::kConfirm, map, scan);
    return Decision::kUndecided;
  }
  stop();
  return Decision::kConfirmed;
}

HypothesisVerifier::Decision HypothesisVerifier::confirm(const Motion& motion, const SearchMap& map,
                                                         const Scan& scan, const Pose2& carried) {
  log_odds_ +=
      decorrelationAfter(motion, scan_decorrelation_distance_) * fieldLogOdds(carried, map, scan);
  if (log_odds_ > kConfirmProven) return Decision::kProven;
  if (log_odds_ < kConfirmRestart) start(Purpose::kConfirm, map, scan);
  return Decision::kUndecided;
}

HypothesisVerifier::Decision HypothesisVerifier::challenge(const Motion& motion,
                                                           const SearchMap& map, const Scan& scan,
                                                           const PoseEstimate& carried) {
  const Pose2& found = candidate_->base_in_map;
  const double distance = isSamePlace(found, carried.base_in_map) ? kNearbyDecorrelationDistance
                                                                  : kDecorrelationDistance;
  log_odds_ += decorrelationAfter(motion, distance) *
               contradictionLogOdds(map.view, found, carried.base_in_map, scan, crossed_obstacle_);
  if (log_odds_ >= kChallengeProven) return Decision::kProven;
  if (log_odds_ > far_prior_log_odds_ + kChallengeRejected && travelled_ <= kMaxChallengeDistance) {
    return Decision::kUndecided;
  }
  stop();
  return Decision::kRejected;
}

double HypothesisVerifier::fieldLogOdds(const Pose2& carried, const SearchMap& map,
                                        const Scan& scan) {
  both_.setPose(0, candidate_->base_in_map);
  both_.setPose(1, carried);
  LikelihoodFieldModel coarse(map.matcher.field());
  scan_likelihood_.evaluate(both_, scan, &coarse, &log_likelihoods_);
  return log_likelihoods_[0] - log_likelihoods_[1];
}

}  // namespace racecar_mcl
