#include "racecar_mcl/sensor/distance_filter.h"

#include <vector>

#include "sensor/beam_residuals.h"

namespace racecar_mcl {
namespace {

// Limits of rejected beams (docs/maths.md).
constexpr float kShortDistance = 0.5f;     // m before the first surface on the ray
constexpr double kSurfaceDistance = 0.15;  // m from every surface
// Minimum fraction of the beams that remain: with fewer, the pose is wrong rather than the beams.
constexpr double kMinRemainingRatio = 0.5;

}  // namespace

Scan withoutShortReturns(const MapView& map, const Pose2& base_in_map, const Scan& beams,
                         Eigen::Index min_beams) {
  BeamResiduals residuals;
  computeBeamResiduals(map, base_in_map, beams, &residuals);
  const float surface_log_likelihood = logLikelihoodNearSurface(map, kSurfaceDistance);
  std::vector<Eigen::Index> kept;
  kept.reserve(static_cast<std::size_t>(beams.size()));
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    const bool is_short = beams.ranges[k] < residuals.expected_ranges(k) - kShortDistance &&
                          residuals.log_likelihoods[k] < surface_log_likelihood;
    if (!is_short) kept.push_back(k);
  }
  const auto remaining = static_cast<Eigen::Index>(kept.size());
  const double min_remaining = kMinRemainingRatio * static_cast<double>(beams.size());
  if (remaining < min_beams || static_cast<double>(remaining) < min_remaining) return beams;
  return takeBeams(beams, kept);
}

}  // namespace racecar_mcl
