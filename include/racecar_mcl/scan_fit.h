// How well a map explains a scan taken from a pose, and in which way it does not.
#pragma once

#include <memory>
#include <vector>

#include "racecar_mcl/pose.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

struct MapModel;

/// What a map says of a beam.
enum class BeamMatch {
  kNotJudged,  ///< proves nothing: no return, nearer than 0.3 m or beyond search_max_range
  kMatched,    ///< ends at a surface: within 0.2 m or a cell
  kShort,      ///< ends in known free space: something is there that the map does not show
  kGrazing,   ///< ends at a surface, over 0.5 m behind another one that a neighbouring beam misses:
              ///< rough walls seen along them do that, and so do wrong poses
  kThrough,   ///< ends over 0.5 m behind the first surface in its way and in its neighbours', or
              ///< inside an obstacle: the pose is wrong, or the surface is gone
  kUnmapped,  ///< ends where the map is unknown: no evidence
};

/// Shares of the beams that could be judged; all 0 where none could.
struct ScanFit {
  double explained = 0.0;     ///< kMatched
  int beams = 0;              ///< that could be judged
  double map_error = 0.0;     ///< m, root mean square distance of matched ends from the surfaces,
                              ///< beyond what the map's cells explain
  double obstructed = 0.0;    ///< kShort
  double contradicted = 0.0;  ///< kThrough
  double unmapped = 0.0;      ///< kUnmapped

  /// The share that speaks against the pose. A beam that ends before a mapped surface counts by
  /// half: people and boxes do that as well.
  double conflict() const { return contradicted + 0.5 * obstructed; }
};

/// Compares scans with a map. Keeps its arrays from scan to scan: it allocates only where a scan
/// has more beams than the ones before.
class ScanMatcher {
 public:
  ScanMatcher();
  ~ScanMatcher();
  ScanMatcher(ScanMatcher&&) noexcept;
  ScanMatcher& operator=(ScanMatcher&&) noexcept;

  /// Of each beam, from the car at this pose. Valid until the next call.
  const std::vector<BeamMatch>& match(MapModel* map, const Pose2& base_in_map, const Scan& beams);
  ScanFit fit(MapModel* map, const Pose2& base_in_map, const Scan& beams);

 private:
  struct Arrays;
  std::unique_ptr<Arrays> arrays_;
};

ScanFit fitScan(MapModel* map, const Pose2& base_in_map, const Scan& beams);

}  // namespace racecar_mcl
