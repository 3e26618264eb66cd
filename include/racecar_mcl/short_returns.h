// Beams that something unmapped has stopped: people, other cars, boxes.
#pragma once

#include "racecar_mcl/pose.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

struct MapModel;

/// The beams without those that, seen from this pose, end in free space and at least 0.5 m before
/// the first wall in their way. A beam that ends within 0.15 m (or a cell) of a surface stays: it
/// may have brushed a corner, and then it tells of the pose. Only right for a pose that is right:
/// where fewer than `least` beams or less than half of them would stay, all do.
Scan withoutShortReturns(MapModel* map, const Pose2& base_in_map, const Scan& beams,
                         Eigen::Index least);

}  // namespace racecar_mcl
