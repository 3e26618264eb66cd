#include "racecar_mcl/relocalization/contradiction.h"

#include <cstddef>
#include <vector>

#include "racecar_mcl/monitoring/scan_match.h"

namespace racecar_mcl {
namespace {

// Log likelihoods of beams, relative to a matched one.
constexpr double kShortLogLikelihood = -1.0;
constexpr double kThroughLogLikelihood = -2.0;
constexpr double kUnmappedLogLikelihood = -1.0;
// Neighbouring beams have correlated errors: this number of beams counts as one.
constexpr double kBeamsPerObservation = 6.5;

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

}  // namespace racecar_mcl
