// Uncertainty of points that are known relative to the car, due to its pose.
#pragma once

#include <Eigen/Core>

namespace racecar_mcl {

/// m^2, covariance due to the pose of a point with this offset (m) from the car, in the map's axes:
/// J C J^T with J = (1 0 -y; 0 1 x).
Eigen::Matrix2d pointCovariance(const Eigen::Matrix3d& pose_covariance,
                                const Eigen::Vector2d& offset);

/// m, the standard deviation along the major axis.
double majorSigma(const Eigen::Matrix2d& covariance);

}  // namespace racecar_mcl
