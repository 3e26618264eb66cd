#include "racecar_mcl/scan_fit.h"

#include <cmath>

#include "seen_beams.h"

namespace racecar_mcl {
namespace {

// A lidar that sees nothing farther away is covered.
constexpr float kClose = 0.3f;    // m
constexpr double kNear = 0.2;     // m
constexpr float kThrough = 0.5f;  // m

}  // namespace

ScanFit fitScan(MapModel* map, const Pose2& base_in_map, const Scan& beams) {
  const SeenBeams seen = seeBeams(map, base_in_map, beams);
  const float least = logLikelihoodNearSurface(*map, kNear);
  ScanFit fit;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (std::isnan(seen.log_likelihoods[k]) || beams.ranges[k] < kClose) continue;
    ++fit.beams;
    const bool through = beams.ranges[k] > seen.walls[k] + kThrough;
    const bool at_surface = seen.log_likelihoods[k] >= least;
    fit.explained += at_surface && !through ? 1.0 : 0.0;
  }
  if (fit.beams > 0) fit.explained /= fit.beams;
  return fit;
}

}  // namespace racecar_mcl
