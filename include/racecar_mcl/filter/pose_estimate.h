// Pose estimates of a weighted particle set: mean or mode, with covariance.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/particle_set.h"

namespace racecar_mcl {

/// A pose with the covariance of (x, y, yaw): m^2, m rad, rad^2.
struct PoseEstimate {
  Pose2 base_in_map;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Standard deviation along the major axis of the position's error ellipse, m.
double positionSigma(const PoseEstimate& estimate);

enum class EstimateFrom {
  kMean,     ///< the weighted mean of all particles (report, section 2.3)
  kBest,     ///< the particle with the largest weight
  kCluster,  ///< the weighted mean of the heaviest cluster, for multimodal sets
};

/// The weighted mean (circular for yaw) and the covariance about it, with the given weights or
/// those of the set. Precondition: at least one particle with a weight above zero. If the circular
/// mean is undefined (the yaws cancel out), the yaw is that of the first particle.
PoseEstimate weightedMean(const ParticleSet& particles, const Eigen::ArrayXd& weights);
PoseEstimate weightedMean(const ParticleSet& particles);
/// The same for plain poses; `weights` holds one value per pose.
PoseEstimate weightedMean(const PoseBatch& poses, const double* weights);

/// The particle with the largest weight, with the covariance of the whole set about it.
PoseEstimate bestParticle(const ParticleSet& particles, const Eigen::ArrayXd& weights);
PoseEstimate bestParticle(const ParticleSet& particles);

/// The estimate of the chosen kind. With `weights` given, kMean and kBest allocate nothing.
PoseEstimate estimatePose(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                          EstimateFrom from);
PoseEstimate estimatePose(const ParticleSet& particles, EstimateFrom from);

/// The estimate after a motion: first-order propagation of the covariance. `delta` and the
/// covariance `noise` (m, m, rad) are in the frame of the car before the motion.
PoseEstimate propagate(const PoseEstimate& estimate, const Pose2& delta,
                       const Eigen::Matrix3d& noise);

}  // namespace racecar_mcl
