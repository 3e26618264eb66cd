// Protection levels: bounds along, across and in heading that the error exceeds with at most a
// given probability, as in the integrity monitoring of satellite navigation.
//
// The covariance of the particles only covers the noise of odometry and scans. Protection levels
// also cover errors of the map: displaced surfaces and unmapped areas (docs/maths.md).
#pragma once

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/monitoring/scan_match.h"

namespace racecar_mcl {

struct ProtectionLevelParameters {
  /// Maximum probability that the error exceeds a level, in (0, 0.5].
  double integrity_risk = 1e-3;
};

/// Throws ParameterError on a risk out of range.
void validate(const ProtectionLevelParameters& parameters);

/// Bounds in the frame of the car.
struct ProtectionLevel {
  double along = 0.0;    ///< m
  double across = 0.0;   ///< m
  double heading = 0.0;  ///< rad, at most pi
};

/// Infinite bounds (heading: pi), as for a set with several clusters.
ProtectionLevel unboundedLevel();

/// The levels of a converged estimate. `match`: of the last scan; `carried`: m driven while the map
/// was not informative (LocalizationStatus::carried).
ProtectionLevel protectionLevel(const ProtectionLevelParameters& parameters,
                                const PoseEstimate& estimate, const ScanMatch& match,
                                double carried);

}  // namespace racecar_mcl
