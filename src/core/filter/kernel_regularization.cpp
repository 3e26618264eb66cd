#include "filter/kernel_regularization.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <sstream>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {

Eigen::Matrix3d matrixSqrt(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d& values = solver.eigenvalues();
  // Tolerance for the rounding of singular covariances.
  if (values.minCoeff() < -1e-9 * std::max(1.0, values.maxCoeff())) {
    std::ostringstream problem;
    problem << "a covariance has a negative eigenvalue (" << values.minCoeff()
            << "); it must be positive semi-definite";
    throw ParameterError(problem.str());
  }
  return solver.eigenvectors() * Eigen::Matrix3d(values.cwiseMax(0.0).cwiseSqrt().asDiagonal());
}

void jitter(const Eigen::Matrix3d& root, Random& random, ParticleSet* particles) {
  ParticleSet& set = *particles;
  for (Eigen::Index i = 0; i < set.size(); ++i) {
    const double a = random.gaussian();
    const double b = random.gaussian();
    const double c = random.gaussian();
    const Eigen::Vector3d offset = root * Eigen::Vector3d(a, b, c);
    set.setPose(i,
                {set.x[i] + offset.x(), set.y[i] + offset.y(), wrapAngle(set.yaw[i] + offset.z())});
  }
}

void shrinkTowardsMean(const Pose2& centre, double fraction, ParticleSet* particles) {
  ParticleSet& set = *particles;
  for (Eigen::Index i = 0; i < set.size(); ++i) {
    set.setPose(i, {set.x[i] + fraction * (centre.x - set.x[i]),
                    set.y[i] + fraction * (centre.y - set.y[i]),
                    wrapAngle(set.yaw[i] + fraction * wrapAngle(centre.yaw - set.yaw[i]))});
  }
}

}  // namespace racecar_mcl
