// From many places to one: what a filter that does not know where it is does differently.
//
// A scan compared with a whole map is deceptive. Corridors repeat, the best fit is often a wrong
// place, and the next scan, taken a hand's breadth further on, errs the same way. So while
// particles stand in several places a scan counts by what is new in it.
#pragma once

#include <optional>
#include <vector>

#include "racecar_mcl/clusters.h"
#include "racecar_mcl/odometry.h"
#include "racecar_mcl/particles.h"

namespace racecar_mcl {

/// The share of a scan, in (0, 1], that the last one did not tell: all of it after `news_distance`
/// (m; 0 = always all of it) driven or a turn of 1 rad per 0.5 m of it. A car that stands still
/// learns a little: its lidar's noise averages out.
double newsAfter(const Motion& motion, double news_distance);

/// The place where all but a ten-thousandth of the weight is, if that is a place: a cluster not
/// wider than 0.3 m. `clusters` as ClusterFinder gives them.
std::optional<Pose2> onlyPlace(const std::vector<Cluster>& clusters);

/// Within 1 m and 0.5 rad of each other.
bool isSamePlace(const Pose2& a, const Pose2& b);

/// Takes the weight from particles that are not in this place and normalises what is left.
void keepNear(const Pose2& place, ParticleSet* particles);

}  // namespace racecar_mcl
