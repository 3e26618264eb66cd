// Evidence of single beams for one pose against another.
#pragma once

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"

namespace racecar_mcl {

/// The log odds, from one scan, of the pose `candidate` against the current pose `carried` (base in
/// map). A beam that passes through a mapped surface counts twice as much as one that ends before
/// it. A beam that ends in an unknown cell is an outlier of the candidate; it is an outlier of the
/// current pose only if `unmapped_counts`.
double contradictionLogOdds(const MapView& map, const Pose2& candidate, const Pose2& carried,
                            const Scan& beams, bool unmapped_counts);

}  // namespace racecar_mcl
