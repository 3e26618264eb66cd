// Residuals of a scan's beams on the map at one pose.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"

namespace racecar_mcl {

/// One value per beam. If reused, it allocates only if a scan has more beams.
struct BeamResiduals {
  /// Log-likelihood of the end point on the map's field; NaN for beams that are not evaluated.
  Eigen::ArrayXf log_likelihoods;
  /// m, to the first surface on the ray; NaN if there is none within the caster's range, so that
  /// comparisons with it are false.
  Eigen::ArrayXXf expected_ranges;  ///< one column
};

void computeBeamResiduals(const MapView& map, const Pose2& base_in_map, const Scan& scan,
                          BeamResiduals* residuals);

/// The log-likelihood, on the map's field, of a beam that ends `distance` (m), but at least one
/// cell, from a surface: distances are measured from cell centres, and a surface is anywhere in its
/// cell.
float logLikelihoodNearSurface(const MapView& map, double distance);

}  // namespace racecar_mcl
