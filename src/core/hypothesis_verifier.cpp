#include "racecar_mcl/hypothesis_verifier.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "racecar_mcl/convergence.h"

namespace racecar_mcl {
namespace {

// To confirm: log odds from which on the second search's place is taken, and from which on it is
// given up. The map that misled one search may mislead the comparison as well, and a new second
// search costs little.
constexpr double kTaken = 20.0;
constexpr double kGivenUp = -10.0;
// Two searches can agree on a place that the car has left since. A scan in such conflict with the
// map does not confirm it.
constexpr double kConfirmedConflict = 0.3;

// To challenge: Wald's bounds for a probability of 1e-6 to take a wrong place and of 0.01 to reject
// the right one.
constexpr double kProvenFrom = 13.8;
constexpr double kRejectedFrom = -4.6;
// What is wrong with a map is wrong for metres: so far apart scans count as independent. To move
// the pose within one place costs little where it was wrong to.
constexpr double kMapErrorLength = 3.0;        // m
constexpr double kMapErrorLengthNearby = 1.0;  // m
// A candidate no farther away is the carried pose itself.
constexpr double kSamePose = 0.15;     // m
constexpr double kSamePoseYaw = 0.08;  // rad
// A challenge that is not decided after this way is given up.
constexpr double kLongestChallenge = 15.0;  // m

// Log likelihoods of a beam against one that matches.
constexpr double kShort = -1.0;
constexpr double kThrough = -2.0;
constexpr double kUnexplained = -1.0;
// Neighbouring beams have correlated errors: this many count as one.
constexpr double kBeamsPerObservation = 6.5;

// How far off the carried pose may be beyond its covariance, and how much less likely a place can
// be for being far away.
constexpr double kCarriedSigma = 0.5;     // m
constexpr double kCarriedYawSigma = 0.2;  // rad
constexpr double kFarawayLogOdds = -10.0;

/// `unmapped`: of a beam that ends where the map is unknown.
double logLikelihood(BeamMatch match, double unmapped) {
  switch (match) {
    case BeamMatch::kShort:
      return kShort;
    case BeamMatch::kThrough:
      return kThrough;
    case BeamMatch::kUnmapped:
      return unmapped;
    default:
      return 0.0;
  }
}

bool isSamePose(const Pose2& a, const Pose2& b) {
  return distance(a, b) <= kSamePose && std::abs(wrapAngle(a.yaw - b.yaw)) <= kSamePoseYaw;
}

/// Before any scan: places within the carried covariance are likelier than places far away, which
/// have the log odds `faraway`.
double priorLogOdds(const Pose2& candidate, const PoseEstimate& carried, double faraway) {
  const Pose2& pose = carried.base_in_map;
  const Eigen::Vector3d offset(candidate.x - pose.x, candidate.y - pose.y,
                               wrapAngle(candidate.yaw - pose.yaw));
  Eigen::Matrix3d covariance = carried.covariance;
  covariance.diagonal() +=
      Eigen::Vector3d(kCarriedSigma * kCarriedSigma, kCarriedSigma * kCarriedSigma,
                      kCarriedYawSigma * kCarriedYawSigma);
  return std::max(faraway, -0.5 * offset.dot(covariance.ldlt().solve(offset)));
}

/// Whether the straight way from one pose to another meets an obstacle of the map.
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

double contradictionLogOdds(MapModel* map, const Pose2& candidate, const Pose2& carried,
                            const Scan& beams, bool unmapped_counts) {
  ScanMatcher at_candidate, at_carried;
  const std::vector<BeamMatch>& there = at_candidate.match(map, candidate, beams);
  const std::vector<BeamMatch>& here = at_carried.match(map, carried, beams);
  double log_odds = 0.0;
  for (std::size_t k = 0; k < here.size(); ++k) {
    log_odds += logLikelihood(there[k], kUnexplained) -
                logLikelihood(here[k], unmapped_counts ? kUnexplained : 0.0);
  }
  return log_odds / kBeamsPerObservation;
}

HypothesisVerifier::HypothesisVerifier(const ParticleFilterParameters& parameters,
                                       const MotionModelParameters& motion, std::uint64_t seed)
    : filter_(parameters, motion, seed),
      weigher_(parameters.num_threads),
      news_distance_(parameters.news_distance) {
  both_.resize(2);
}

void HypothesisVerifier::start(Purpose purpose, const MapModel& map, const Scan& beams,
                               bool carried_is_confirmed) {
  filter_.initializeGlobally(map, beams);
  purpose_ = purpose;
  faraway_log_odds_ = carried_is_confirmed ? kFarawayLogOdds : 0.0;
  candidate_.reset();
  log_odds_ = 0.0;
  travelled_ = 0.0;
  last_carried_.reset();
  through_wall_ = false;
}

HypothesisVerifier::Decision HypothesisVerifier::update(const Motion& motion, MapModel* map,
                                                        const Scan& beams,
                                                        const PoseEstimate& carried) {
  filter_.predict(motion);
  const UpdateResult& update = filter_.update(map, beams);
  travelled_ += motion.distance;
  if (last_carried_) {
    through_wall_ =
        through_wall_ || crossesObstacle(map->grid, *last_carried_, carried.base_in_map);
  }
  last_carried_ = carried.base_in_map;
  if (filter_.converging()) {
    if (challenging() && travelled_ > kLongestChallenge) {
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
  if (agrees) return agree(map, beams);
  if (confirming()) return confirm(motion, map, beams, carried.base_in_map);
  if (is_new) {
    log_odds_ = priorLogOdds(found, carried, faraway_log_odds_);
    return Decision::kUndecided;
  }
  return challenge(motion, map, beams, carried);
}

HypothesisVerifier::Decision HypothesisVerifier::agree(MapModel* map, const Scan& beams) {
  if (confirming() &&
      matcher_.fit(map, candidate_->base_in_map, beams).conflict() > kConfirmedConflict) {
    start(Purpose::kConfirm, *map, beams);
    return Decision::kUndecided;
  }
  stop();
  return Decision::kConfirmed;
}

HypothesisVerifier::Decision HypothesisVerifier::confirm(const Motion& motion, MapModel* map,
                                                         const Scan& beams, const Pose2& carried) {
  log_odds_ += newsAfter(motion, news_distance_) * fieldLogOdds(carried, *map, beams);
  if (log_odds_ > kTaken) return Decision::kProven;
  if (log_odds_ < kGivenUp) start(Purpose::kConfirm, *map, beams);
  return Decision::kUndecided;
}

HypothesisVerifier::Decision HypothesisVerifier::challenge(const Motion& motion, MapModel* map,
                                                           const Scan& beams,
                                                           const PoseEstimate& carried) {
  const Pose2& found = candidate_->base_in_map;
  const double length =
      isSamePlace(found, carried.base_in_map) ? kMapErrorLengthNearby : kMapErrorLength;
  log_odds_ += newsAfter(motion, length) *
               contradictionLogOdds(map, found, carried.base_in_map, beams, through_wall_);
  if (log_odds_ >= kProvenFrom) return Decision::kProven;
  if (log_odds_ > faraway_log_odds_ + kRejectedFrom && travelled_ <= kLongestChallenge) {
    return Decision::kUndecided;
  }
  stop();
  return Decision::kRejected;
}

double HypothesisVerifier::fieldLogOdds(const Pose2& carried, const MapModel& map,
                                        const Scan& beams) {
  both_.setPose(0, candidate_->base_in_map);
  both_.setPose(1, carried);
  const Eigen::ArrayXd& fits = weigher_.weigh(map.search.field(), both_, beams);
  return fits[0] - fits[1];
}

}  // namespace racecar_mcl
