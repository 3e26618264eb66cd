// A scan's beams held against the map from one pose.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/pose.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

struct MapModel;

/// Of each beam. Kept from scan to scan, it allocates only where a scan has more beams.
struct SeenBeams {
  /// Of its end, by the map's field of places; NaN for a beam the field does not weigh.
  Eigen::ArrayXf log_likelihoods;
  /// m, to the first wall in its way; NaN where there is none in the caster's range, so that no
  /// beam ends before it or beyond it.
  Eigen::ArrayXXf walls;  ///< one column
};

void seeBeams(MapModel* map, const Pose2& base_in_map, const Scan& beams, SeenBeams* seen);

/// The log-likelihood, by the map's field of places, of a beam that ends `distance` m from a
/// surface, or a cell where that is more: a surface lies anywhere in its cell, and the field is
/// measured from the cell's centre.
float logLikelihoodNearSurface(const MapModel& map, double distance);

}  // namespace racecar_mcl
