// Derivatives of a scan's log-likelihood.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

/// Score of each of K beams: the derivatives of its log-likelihood, without the exponent, by the
/// lidar's x, y (1/m) and yaw (1/rad) in the map and by the range bias (1/m); 4 x K. Central
/// differences over half a cell of 0.05 m. Columns of beams that are not evaluated are zero.
Eigen::Matrix4Xd beamScores(const LikelihoodField& field, const Pose2& lidar_in_map,
                            const Scan& beams);

}  // namespace racecar_mcl
