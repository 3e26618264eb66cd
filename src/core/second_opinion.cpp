#include "racecar_mcl/second_opinion.h"

#include "racecar_mcl/convergence.h"

namespace racecar_mcl {
namespace {

// Log odds from which on the second place is taken, and from which on it is given up. The map that
// misled one search may mislead the comparison as well, and a new second search costs little.
constexpr double kTaken = 20.0;
constexpr double kGivenUp = -10.0;

}  // namespace

SecondOpinion::SecondOpinion(const ParticleFilterParameters& parameters,
                             const MotionModelParameters& motion, std::uint64_t seed)
    : filter_(parameters, motion, seed),
      weigher_(parameters.num_threads),
      news_distance_(parameters.news_distance) {
  both_.resize(2);
}

void SecondOpinion::ask(const MapModel& map, const Scan& beams) {
  filter_.initializeGlobally(map, beams);
  evidence_ = 0.0;
  pending_ = true;
}

SecondOpinion::Answer SecondOpinion::hear(const Motion& motion, MapModel* map, const Scan& beams,
                                          const Pose2& first) {
  filter_.predict(motion);
  const UpdateResult& update = filter_.update(map, beams);
  if (filter_.converging()) return Answer::kNotYet;
  const Pose2& second = update.estimate.base_in_map;
  if (isSamePlace(second, first)) {
    pending_ = false;
    return Answer::kAgrees;
  }
  evidence_ += newsAfter(motion, news_distance_) * logOdds(second, first, *map, beams);
  if (evidence_ > kTaken) return Answer::kObjects;
  if (evidence_ < kGivenUp) ask(*map, beams);
  return Answer::kNotYet;
}

double SecondOpinion::logOdds(const Pose2& second, const Pose2& first, const MapModel& map,
                              const Scan& beams) {
  both_.setPose(0, second);
  both_.setPose(1, first);
  const Eigen::ArrayXd& fits = weigher_.weigh(map.search.field(), both_, beams);
  return fits[0] - fits[1];
}

}  // namespace racecar_mcl
