// Tests another place on the map against the one where the car is taken to be, by a sequential
// probability ratio test (Wald 1945).
//
// Corridors repeat, and no map is right everywhere: for metres on end a wrong place may explain the
// scans better than the right one. So a place found on the whole map is a hypothesis until scans
// that had no part in finding it have decided.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "racecar_mcl/map_model.h"
#include "racecar_mcl/motion_model.h"
#include "racecar_mcl/particle_filter.h"
#include "racecar_mcl/scan_fit.h"
#include "racecar_mcl/scan_weigher.h"

namespace racecar_mcl {

/// The log odds, from one scan, of `candidate` against `carried` (the car's poses in the map). A
/// beam that passes through a mapped surface counts twice as much as one that ends before it. A
/// beam that ends where the map is unknown is not explained by the candidate. It is evidence
/// against the carried pose only where `unmapped_counts`.
double contradictionLogOdds(MapModel* map, const Pose2& candidate, const Pose2& carried,
                            const Scan& beams, bool unmapped_counts);

class HypothesisVerifier {
 public:
  /// Why another place is looked for.
  enum class Purpose {
    kConfirm,    ///< a search has settled on a place: would another search find it as well?
    kChallenge,  ///< scans contradict the place where the car is taken to be
  };

  enum class Decision {
    kUndecided,
    kConfirmed,  ///< the second search has settled on the carried place; of a challenge: on the
                 ///< carried pose itself
    kRejected,   ///< of a challenge: the carried place is as good or better
    kProven,     ///< `particles` stand in a place that explains what the carried one contradicts
  };

  /// A filter of its own. Throws as ParticleFilter.
  HypothesisVerifier(const ParticleFilterParameters& parameters,
                     const MotionModelParameters& motion, std::uint64_t seed);

  /// Begins a search of the whole map where this scan fits. Replaces one that is under way. A
  /// carried pose that scans have never confirmed is no likelier than any other.
  void start(Purpose purpose, const MapModel& map, const Scan& beams,
             bool carried_is_confirmed = true);
  void stop() { purpose_.reset(); }

  bool confirming() const { return purpose_ == Purpose::kConfirm; }
  bool challenging() const { return purpose_ == Purpose::kChallenge; }

  /// Follows the car by one scan, after which it is taken to be at `carried`. To confirm a place, a
  /// second search that ended where the scans fit far worse, or where they contradict the map, is
  /// begun again. No search is under way after kConfirmed and kRejected.
  Decision update(const Motion& motion, MapModel* map, const Scan& beams,
                  const PoseEstimate& carried);

  /// The place being tested, once the search has settled on one.
  const std::optional<PoseEstimate>& candidate() const { return candidate_; }
  /// That it is the right one of the two.
  double candidateProbability() const { return 1.0 / (1.0 + std::exp(-log_odds_)); }
  const ParticleSet& particles() const { return filter_.particles(); }

 private:
  Decision agree(MapModel* map, const Scan& beams);
  Decision confirm(const Motion& motion, MapModel* map, const Scan& beams, const Pose2& carried);
  Decision challenge(const Motion& motion, MapModel* map, const Scan& beams,
                     const PoseEstimate& carried);
  double fieldLogOdds(const Pose2& carried, const MapModel& map, const Scan& beams);

  ParticleFilter filter_;
  ScanWeigher weigher_;
  ScanMatcher matcher_;
  ParticleSet both_;  ///< the candidate and the carried pose
  double news_distance_;
  std::optional<Purpose> purpose_;  ///< of the search under way
  std::optional<PoseEstimate> candidate_;
  double faraway_log_odds_ = 0.0;  ///< of a place far away, before any scan
  double log_odds_ = 0.0;          ///< of the candidate against the carried place
  double travelled_ = 0.0;         ///< m since the search began
  std::optional<Pose2> last_carried_;
  bool through_wall_ = false;  ///< the carried pose has passed through a wall: it did not leave the
                               ///< mapped space as a car does
};

}  // namespace racecar_mcl
