// Asks the map once more before a place that was found on the whole of it is believed.
//
// Corridors repeat, and no map is right everywhere: for metres on end a wrong place may explain the
// scans better than the right one, until the right one has no particle left. What is wrong with one
// stretch of the way is seldom wrong with the next. So when a search has settled, a second one
// begins from there, knowing nothing of the first; only when both agree is the place believed.
#pragma once

#include <cstdint>

#include "racecar_mcl/map_model.h"
#include "racecar_mcl/motion_model.h"
#include "racecar_mcl/particle_filter.h"
#include "racecar_mcl/scan_weigher.h"

namespace racecar_mcl {

class SecondOpinion {
 public:
  /// A filter of its own. Throws as ParticleFilter.
  SecondOpinion(const ParticleFilterParameters& parameters, const MotionModelParameters& motion,
                std::uint64_t seed);

  /// Begins a search where the scan fits, whatever was asked before.
  void ask(const MapModel& map, const Scan& beams);
  void drop() { pending_ = false; }
  /// Asked, and not agreed yet.
  bool pending() const { return pending_; }

  enum class Answer {
    kNotYet,
    kAgrees,
    kObjects,  ///< `particles` stand in a place from which the scans since are explained far better
  };
  /// Follows the car by one scan, after which the first search has it at `first`. A second search
  /// that ended where the scans since fit far worse is begun again.
  Answer hear(const Motion& motion, MapModel* map, const Scan& beams, const Pose2& first);
  const ParticleSet& particles() const { return filter_.particles(); }

 private:
  double logOdds(const Pose2& second, const Pose2& first, const MapModel& map, const Scan& beams);

  ParticleFilter filter_;
  ScanWeigher weigher_;
  ParticleSet both_;  ///< the second search's place and the first's
  double news_distance_;
  double evidence_ = 0.0;  ///< log odds of the second search's place against the first's
  bool pending_ = false;
};

}  // namespace racecar_mcl
