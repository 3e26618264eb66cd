// The common case of a set that has settled, found without a histogram of it.
#pragma once

#include "racecar_mcl/particles.h"
#include "racecar_mcl/pose_bins.h"

namespace racecar_mcl {

/// Whether all particles lie in bins that touch, across edges and corners. Needs at least one.
/// Allocates nothing. False, too, for sets wider than some 60 bins, and bins of more than 32 yaws.
bool lieInOnePlace(const ParticleSet& particles, const PoseBins& bins);

}  // namespace racecar_mcl
