// Spreading the copies that resampling made of one particle: a regularised particle filter's step
// (Musso, Oudjane and Le Gland 2001).
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/particles.h"
#include "racecar_mcl/pose.h"
#include "racecar_mcl/random.h"

namespace racecar_mcl {

/// A square root of a covariance; throws ParameterError where the matrix is none.
Eigen::Matrix3d rootOf(const Eigen::Matrix3d& covariance);

/// Moves every particle by a Gaussian kernel: a covariance of (m, m, rad) by its root.
void spread(const Eigen::Matrix3d& root, Random& random, ParticleSet* particles);

/// Moves every particle this share of its way to `centre`.
void drawTogether(const Pose2& centre, double share, ParticleSet* particles);

}  // namespace racecar_mcl
