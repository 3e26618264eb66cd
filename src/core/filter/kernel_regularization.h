// Kernel regularization of a resampled set (Musso, Oudjane and Le Gland 2001; Liu and West 2001).
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// A matrix square root R with R R^T = covariance. Throws ParameterError if the matrix is not
/// positive semi-definite.
Eigen::Matrix3d matrixSqrt(const Eigen::Matrix3d& covariance);

/// Adds Gaussian noise to every particle: `root` is the matrix square root of the covariance (m, m,
/// rad).
void jitter(const Eigen::Matrix3d& root, Random& random, ParticleSet* particles);

/// Moves every particle by `fraction` of its distance to `centre`.
void shrinkTowardsMean(const Pose2& centre, double fraction, ParticleSet* particles);

}  // namespace racecar_mcl
