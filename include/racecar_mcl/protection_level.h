// How far off the estimate may be: a bound along, across and in heading that the error exceeds with
// at most a chosen probability, as integrity monitoring of satellite navigation has it.
//
// The covariance of the particles answers for the noise of odometry and scans alone. What a
// protection level answers for besides is the map: surfaces that are not where it draws them, and
// stretches that it does not show.
#pragma once

#include "racecar_mcl/pose_estimate.h"
#include "racecar_mcl/scan_fit.h"

namespace racecar_mcl {

struct ProtectionLevelParameters {
  double protection_risk = 1e-3;  ///< probability that the error exceeds a level, in (0, 0.5]
};

/// Throws ParameterError on a risk out of range.
void validate(const ProtectionLevelParameters& parameters);

/// In the frame of the car.
struct ProtectionLevel {
  double along = 0.0;    ///< m
  double across = 0.0;   ///< m
  double heading = 0.0;  ///< rad, at most pi
};

/// Infinite (heading: pi): nothing is known, as while particles are in several places.
ProtectionLevel unboundedLevel();

/// Of an estimate in one place. `fit`: of the scan that led to it; `carried`: m driven since the
/// map last explained the scans.
ProtectionLevel protectionLevel(const ProtectionLevelParameters& parameters,
                                const PoseEstimate& estimate, const ScanFit& fit, double carried);

}  // namespace racecar_mcl
