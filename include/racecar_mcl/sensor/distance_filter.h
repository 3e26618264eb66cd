// Distance filter (Fox, Burgard and Thrun 1999): rejects beams that end at unmapped obstacles.
#pragma once

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"

namespace racecar_mcl {

/// The beams without those that, from this pose, end in free space over 0.5 m before the first
/// surface on their rays. Beams that end within 0.15 m (or a cell) of a surface are kept, since
/// they may have hit a corner. Precondition: the pose is approximately right. If fewer than
/// `min_beams` or less than half of the beams would remain, all are returned.
Scan withoutShortReturns(const MapView& map, const Pose2& base_in_map, const Scan& beams,
                         Eigen::Index min_beams);

}  // namespace racecar_mcl
