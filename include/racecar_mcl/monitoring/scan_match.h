// Comparison of a scan with the map at a pose: inliers and kinds of outliers.
#pragma once

#include <memory>
#include <vector>

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"

namespace racecar_mcl {

/// Classes of beams.
enum class BeamMatch {
  kNotJudged,  ///< not evaluated: no return, range below 0.3 m or beyond search_max_range
  kMatched,    ///< ends at a surface: within 0.2 m or one cell, whichever is larger
  kShort,      ///< ends in known free space: an unmapped obstacle
  kGrazing,   ///< ends at a surface, over 0.5 m behind another one that a neighbouring beam misses,
              ///< as for rough walls at grazing angles and at wrong poses
  kThrough,   ///< ends over 0.5 m behind the first surface on its ray and on its neighbours' rays,
              ///< or inside an obstacle: the pose is wrong, or the surface was removed
  kUnmapped,  ///< ends in an unknown cell: no evidence
};

/// Fractions of the evaluated beams; all 0 if there are none.
struct ScanMatch {
  double inlier_ratio = 0.0;  ///< kMatched
  int beams = 0;              ///< evaluated beams
  double map_error = 0.0;     ///< m, root mean square distance of matched end points from the
                              ///< surfaces, without the part due to the cell size
  double obstructed = 0.0;    ///< kShort
  double contradicted = 0.0;  ///< kThrough
  double unmapped = 0.0;      ///< kUnmapped

  /// Fraction of the beams that contradict the pose. Beams that end before a mapped surface count
  /// half, since unmapped obstacles have the same effect.
  double conflict() const { return contradicted + 0.5 * obstructed; }
};

/// Reuses its arrays: allocates only if a scan has more beams than all earlier ones.
class ScanMatchEvaluator {
 public:
  ScanMatchEvaluator();
  ~ScanMatchEvaluator();
  ScanMatchEvaluator(ScanMatchEvaluator&&) noexcept;
  ScanMatchEvaluator& operator=(ScanMatchEvaluator&&) noexcept;

  /// The class of each beam, with the car at this pose. Valid until the next call.
  const std::vector<BeamMatch>& classifyBeams(const MapView& map, const Pose2& base_in_map,
                                              const Scan& beams);
  /// The same with one inlier distance per beam (m, at least a cell) instead of 0.2 m.
  const std::vector<BeamMatch>& classifyBeams(const MapView& map, const Pose2& base_in_map,
                                              const Scan& beams,
                                              const Eigen::ArrayXf& inlier_distances);
  /// m, K x 1, to the first surface on each ray of the last call; NaN if there is none.
  const Eigen::ArrayXXf& expectedRanges() const;
  ScanMatch evaluate(const MapView& map, const Pose2& base_in_map, const Scan& beams);

 private:
  struct Arrays;
  const std::vector<BeamMatch>& classify(const MapView& map, const Pose2& base_in_map,
                                         const Scan& beams);
  std::unique_ptr<Arrays> arrays_;
};

ScanMatch evaluateScanMatch(const MapView& map, const Pose2& base_in_map, const Scan& beams);

}  // namespace racecar_mcl
