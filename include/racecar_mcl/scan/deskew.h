// Deskewing: corrects a sweep for the car's motion during its acquisition.
#pragma once

#include <functional>

#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {

/// The car's pose at a time after the scan's stamp (s), in its frame at the stamp, or at the pose
/// to which the scan is moved.
using BaseAfter = std::function<Pose2(double seconds)>;

/// The sweep as seen from the lidar's pose at the scan's stamp: every end point is transformed by
/// the car's motion between the stamp and its beam, interpolated between times that are at
/// most a millisecond apart, but never more times than beams. The times must be finite. Beams
/// without a return keep +inf; only their bearings change.
Scan deskew(const Scan& scan, const BaseAfter& base_after);

}  // namespace racecar_mcl
