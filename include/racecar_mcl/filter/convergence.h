// Convergence of a global localization: from several clusters to one.
//
// Maps are ambiguous (perceptual aliasing): the best match of a single scan is often a wrong place,
// and consecutive scans have correlated errors. Until the set has converged, the likelihood of a
// scan is therefore raised to an exponent that grows with the distance driven since the last one.
#pragma once

#include <optional>
#include <vector>

#include "racecar_mcl/filter/clustering.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/motion/odometry_buffer.h"

namespace racecar_mcl {

/// The exponent of a scan's likelihood, in (0, 1], after a motion since the last scan: the distance
/// driven (m, plus 0.5 m per rad turned) divided by `scan_decorrelation_distance` (m; 0 = the
/// exponent is always 1). At least 0.02, since the noise of the lidar is independent from scan to
/// scan.
double decorrelationAfter(const Motion& motion, double scan_decorrelation_distance);

/// The mean of the heaviest cluster if it holds at least 99.99 % of the weight and its position has
/// a standard deviation of at most 0.3 m. `clusters`: heaviest first, as from ClusterFinder.
std::optional<Pose2> singleCluster(const std::vector<Cluster>& clusters);

/// Whether two poses are within 1 m and 0.5 rad of each other.
bool isSamePlace(const Pose2& a, const Pose2& b);

/// Sets the weight of particles that are not at this place (isSamePlace) to zero and normalises the
/// others.
void keepNear(const Pose2& place, ParticleSet* particles);

}  // namespace racecar_mcl
