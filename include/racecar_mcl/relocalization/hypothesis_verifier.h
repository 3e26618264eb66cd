// Sequential probability ratio test (Wald 1945) of an alternative pose on the map against the
// current one.
//
// Because of perceptual aliasing and map errors, a wrong place can match the scans better than the
// right one over metres. A place found by a search of the whole map is therefore a hypothesis,
// which is tested with later scans: against all other places after a global start, and against the
// current pose if that is in doubt.
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

class HypothesisVerifier {
 public:
  enum class Decision {
    kUndecided,
    kConfirmed,  ///< no other place (of a challenge: pose) matches the scans as well
    kRejected,   ///< of a challenge: the alternative is not better than the current pose
    kProven,     ///< the alternative, in `particles`, replaces the current pose
  };

  /// Searches with a particle filter of its own. Throws as ParticleFilter.
  HypothesisVerifier(const ParticleFilterParameters& parameters,
                     const MotionModelParameters& motion, std::uint64_t seed);

  /// A running search is kept. Throws ParameterError, and then changes nothing.
  void setParameters(const ParticleFilterParameters& parameters,
                     const MotionModelParameters& motion);

  /// Confirmation of the result of a global search: a search of the whole map with this scan has to
  /// converge to the same place, and then a search of the rest of the map to no place that is as
  /// likely. Replaces a running search.
  void startConfirmation(const SearchMap& map, const Scan& scan);
  /// Challenge of a pose that scans contradict: searches the whole map with this scan. Without
  /// `carried_is_confirmed`, the current pose has no prior advantage over others. Replaces a
  /// running search.
  void startChallenge(const SearchMap& map, const Scan& scan, bool carried_is_confirmed = true);
  void stop() { purpose_.reset(); }

  bool confirming() const { return purpose_ && !challenging(); }
  bool challenging() const { return purpose_ == Purpose::kChallenge; }

  /// Processes one scan. `motion`: since the last scan; `carried`: the estimate at this scan. A
  /// confirmation starts again instead of succeeding with a scan that contradicts the map. No
  /// search is running after kConfirmed and kRejected.
  Decision update(const Motion& motion, const SearchMap& map, const Scan& scan,
                  const PoseEstimate& carried);

  /// The alternative under test; none until the search has converged.
  const std::optional<PoseEstimate>& candidate() const { return candidate_; }
  /// The probability that the alternative is the right one of the two.
  double candidateProbability() const { return 1.0 / (1.0 + std::exp(-log_odds_)); }
  const ParticleSet& particles() const { return filter_.particles(); }

 private:
  enum class Purpose { kAgreement, kOtherPlaces, kChallenge };

  /// Starts a search of the map, except around a pose if one is given.
  void start(Purpose purpose, const SearchMap& map, const Scan& scan,
             const std::optional<Pose2>& except);
  Decision agree(const Motion& motion, const SearchMap& map, const Scan& scan,
                 const Pose2& carried);
  /// `best_match`: of the search, at this scan. `is_new`: the alternative was found with this scan.
  Decision ruleOut(const Motion& motion, const SearchMap& map, const Scan& scan,
                   const Pose2& carried, const Pose2& best_match, bool is_new);
  Decision challenge(const Motion& motion, const SearchMap& map, const Scan& scan,
                     const PoseEstimate& carried, bool is_new);
  Decision reject();
  double decorrelation(const Motion& motion) const;
  /// Adds the log odds of another pose against the current one by the coarse field.
  void addFieldEvidence(const Pose2& other, const Pose2& carried, double weight,
                        const SearchMap& map, const Scan& scan);

  ParticleFilter filter_;
  ScanLikelihood scan_likelihood_;
  ScanMatchEvaluator match_evaluator_;
  Eigen::ArrayXd log_likelihoods_;  ///< of `both_`
  int num_threads_;
  ParticleSet both_;  ///< another pose and the current one
  double scan_decorrelation_distance_;
  std::optional<Purpose> purpose_;  ///< of the running search
  std::optional<PoseEstimate> candidate_;
  double far_prior_log_odds_ = 0.0;  ///< prior of places far from the current pose
  double log_odds_ = 0.0;            ///< of the alternative against the current pose
  int scans_ = 0;                    ///< of the search of other places
  double travelled_ = 0.0;           ///< m since the start of the search
  std::optional<Pose2> last_carried_;
  bool crossed_obstacle_ = false;  ///< the current pose has moved through a wall, so that unmapped
                                   ///< cells do not explain its scans
};

}  // namespace racecar_mcl
