// Fast path of the clustering for converged sets: a dense occupancy grid instead of a hash table.
#pragma once

#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/geometry/pose_histogram.h"

namespace racecar_mcl {

/// Whether all particles are in one connected component of bins (across faces, edges and corners).
/// Precondition: at least one particle. Allocates nothing. Returns false as well, without deciding,
/// for sets wider than about 60 bins and for histograms with more than 32 yaw bins.
bool formSingleCluster(const ParticleSet& particles, const PoseBins& bins);

}  // namespace racecar_mcl
