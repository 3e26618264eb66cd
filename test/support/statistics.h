// Sample moments and their confidence bounds.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "racecar_mcl/geometry/particle_set.h"

namespace racecar_mcl {

/// Unweighted mean and covariance of (x, y, yaw) of a set. Only for yaws that do not wrap.
struct SetMoments {
  Eigen::Vector3d mean;
  Eigen::Matrix3d covariance;
};

inline SetMoments momentsOf(const ParticleSet& particles) {
  const auto count = static_cast<double>(particles.size());
  Eigen::MatrixX3d samples(particles.size(), 3);
  samples << particles.x.matrix(), particles.y.matrix(), particles.yaw.matrix();
  SetMoments moments;
  moments.mean = samples.colwise().mean().transpose();
  const Eigen::MatrixX3d centred = samples.rowwise() - moments.mean.transpose();
  moments.covariance = centred.transpose() * centred / (count - 1.0);
  return moments;
}

/// Relative tolerance of the variance of `count` normal samples: five standard deviations of the
/// chi-squared distribution with count - 1 degrees of freedom.
inline double varianceTolerance(double count) { return 5.0 * std::sqrt(2.0 / (count - 1.0)); }

}  // namespace racecar_mcl
