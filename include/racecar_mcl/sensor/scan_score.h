// Derivatives of a scan's log-likelihood: what range bias and localizability are estimated from.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

/// With respect to the lidar's x, y (m) and yaw (rad) in the map and to the range bias (m).
struct ScanScore {
  Eigen::Vector4d score = Eigen::Vector4d::Zero();  ///< gradient of the log-likelihood
  /// Fisher information: the sum of the outer products of the beams' scores.
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
};

/// The score of a scan at this pose, with the field's exponent. Central differences over half a
/// cell of 0.05 m. Beams that are not evaluated have no part in it.
ScanScore scanScore(const LikelihoodField& field, const Pose2& lidar_in_map, const Scan& beams);

}  // namespace racecar_mcl
