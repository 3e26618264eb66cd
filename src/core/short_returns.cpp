#include "racecar_mcl/short_returns.h"

#include <vector>

#include "seen_beams.h"

namespace racecar_mcl {
namespace {

constexpr float kBefore = 0.5f;          // m
constexpr double kAtSurface = 0.15;      // m
constexpr Eigen::Index kOneStaysOf = 2;  // beams, at least

}  // namespace

Scan withoutShortReturns(MapModel* map, const Pose2& base_in_map, const Scan& beams,
                         Eigen::Index least) {
  SeenBeams seen;
  seeBeams(map, base_in_map, beams, &seen);
  const float free = logLikelihoodNearSurface(*map, kAtSurface);
  std::vector<Eigen::Index> kept;
  kept.reserve(static_cast<std::size_t>(beams.size()));
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    const bool stopped =
        beams.ranges[k] < seen.walls(k) - kBefore && seen.log_likelihoods[k] < free;
    if (!stopped) kept.push_back(k);
  }
  const auto staying = static_cast<Eigen::Index>(kept.size());
  if (staying < least || kOneStaysOf * staying < beams.size()) return beams;
  return takeBeams(beams, kept);
}

}  // namespace racecar_mcl
