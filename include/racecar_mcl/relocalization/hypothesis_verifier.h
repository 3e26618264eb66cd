// Sequential probability ratio test (Wald 1945) of an alternative pose on the map against the
// current one.
//
// Because of perceptual aliasing and map errors, a wrong place can match the scans better than the
// right one over metres. A place found by a search of the whole map is therefore a hypothesis,
// which is tested with later scans.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/monitoring/scan_match.h"
#include "racecar_mcl/motion/motion_model.h"
#include "racecar_mcl/relocalization/search_map.h"
#include "racecar_mcl/sensor/scan_likelihood.h"

namespace racecar_mcl {

/// The log odds, from one scan, of the pose `candidate` against the current pose `carried` (base in
/// map). A beam that passes through a mapped surface counts twice as much as one that ends before
/// it. A beam that ends in an unknown cell is an outlier of the candidate; it is an outlier of the
/// current pose only if `unmapped_counts`.
double contradictionLogOdds(const MapView& map, const Pose2& candidate, const Pose2& carried,
                            const Scan& beams, bool unmapped_counts);

class HypothesisVerifier {
 public:
  enum class Purpose {
    kConfirm,    ///< confirm the result of a global search by a second search
    kChallenge,  ///< find an alternative to a pose that scans contradict
  };

  enum class Decision {
    kUndecided,
    kConfirmed,  ///< the search has converged to the current place (of a challenge: pose)
    kRejected,   ///< of a challenge: the alternative is not better than the current pose
    kProven,     ///< the alternative, in `particles`, replaces the current pose
  };

  /// Searches with a particle filter of its own. Throws as ParticleFilter.
  HypothesisVerifier(const ParticleFilterParameters& parameters,
                     const MotionModelParameters& motion, std::uint64_t seed);

  /// A running search is kept. Throws ParameterError, and then changes nothing.
  void setParameters(const ParticleFilterParameters& parameters,
                     const MotionModelParameters& motion);

  /// Starts a search of the whole map with this scan; replaces a running one. Without
  /// `carried_is_confirmed`, the current pose has no prior advantage over others.
  void start(Purpose purpose, const SearchMap& map, const Scan& scan,
             bool carried_is_confirmed = true);
  void stop() { purpose_.reset(); }

  bool confirming() const { return purpose_ == Purpose::kConfirm; }
  bool challenging() const { return purpose_ == Purpose::kChallenge; }

  /// Processes one scan. `motion`: since the last scan; `carried`: the estimate at this scan. A
  /// search with purpose kConfirm restarts if its result matches the scans much worse than
  /// `carried` or contradicts the map. No search is running after kConfirmed and kRejected.
  Decision update(const Motion& motion, const SearchMap& map, const Scan& scan,
                  const PoseEstimate& carried);

  /// The alternative under test; none until the search has converged.
  const std::optional<PoseEstimate>& candidate() const { return candidate_; }
  /// The probability that the alternative is the right one of the two.
  double candidateProbability() const { return 1.0 / (1.0 + std::exp(-log_odds_)); }
  const ParticleSet& particles() const { return filter_.particles(); }

 private:
  Decision onAgreement(const SearchMap& map, const Scan& scan);
  Decision confirm(const Motion& motion, const SearchMap& map, const Scan& scan,
                   const Pose2& carried);
  Decision challenge(const Motion& motion, const SearchMap& map, const Scan& scan,
                     const PoseEstimate& carried);
  double fieldLogOdds(const Pose2& carried, const SearchMap& map, const Scan& scan);

  ParticleFilter filter_;
  ScanLikelihood scan_likelihood_;
  ScanMatchEvaluator match_evaluator_;
  Eigen::ArrayXd log_likelihoods_;  ///< of `both_`
  int num_threads_;
  ParticleSet both_;  ///< the alternative and the current pose
  double scan_decorrelation_distance_;
  std::optional<Purpose> purpose_;  ///< of the running search
  std::optional<PoseEstimate> candidate_;
  double far_prior_log_odds_ = 0.0;  ///< prior of places far from the current pose
  double log_odds_ = 0.0;            ///< of the alternative against the current pose
  double travelled_ = 0.0;           ///< m since the start of the search
  std::optional<Pose2> last_carried_;
  bool crossed_obstacle_ = false;  ///< the current pose has moved through a wall, so that unmapped
                                   ///< cells do not explain its scans
};

}  // namespace racecar_mcl
