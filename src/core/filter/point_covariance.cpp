#include "racecar_mcl/filter/point_covariance.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {

Eigen::Matrix2d pointCovariance(const Eigen::Matrix3d& pose_covariance,
                                const Eigen::Vector2d& offset) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << 1.0, 0.0, -offset.y(), 0.0, 1.0, offset.x();
  return jacobian * pose_covariance * jacobian.transpose();
}

double majorSigma(const Eigen::Matrix2d& covariance) {
  // The larger eigenvalue.
  const double mean = 0.5 * covariance.trace();
  const double half_difference = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return std::sqrt(std::max(0.0, mean + std::hypot(half_difference, covariance(0, 1))));
}

}  // namespace racecar_mcl
