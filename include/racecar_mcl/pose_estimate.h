// From a weighted particle set to one pose with its uncertainty.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/particles.h"

namespace racecar_mcl {

/// A pose with the covariance of (x, y, yaw): m^2, m rad, rad^2.
struct PoseEstimate {
  Pose2 base_in_map;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// m, of the longer axis of the position's ellipse.
double positionSigma(const PoseEstimate& estimate);

enum class EstimateFrom {
  kMean,     ///< the weighted mean of all particles (report, section 2.3)
  kBest,     ///< the particle with the largest weight
  kCluster,  ///< the weighted mean of the heaviest cluster: never between two places
};

/// The weighted mean (yaw by its circular mean) and covariance about it, with the weights given or
/// those of the set. Needs at least one particle, and a weight above zero. Of yaws that cancel out
/// the result is the first particle's.
PoseEstimate weightedMean(const ParticleSet& particles, const Eigen::ArrayXd& weights);
PoseEstimate weightedMean(const ParticleSet& particles);
/// The same of poses that are no set, with as many weights.
PoseEstimate weightedMean(const PoseBatch& poses, const double* weights);

/// The heaviest particle, with the covariance of the whole set about it.
PoseEstimate bestParticle(const ParticleSet& particles, const Eigen::ArrayXd& weights);
PoseEstimate bestParticle(const ParticleSet& particles);

/// The estimate of the chosen kind. With the weights at hand, mean and best allocate nothing.
PoseEstimate estimatePose(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                          EstimateFrom from);
PoseEstimate estimatePose(const ParticleSet& particles, EstimateFrom from);

/// The estimate after a motion with noise of the given covariance (in the frame of the car before
/// the motion).
PoseEstimate carryForward(const PoseEstimate& estimate, const Pose2& delta,
                          const Eigen::Matrix3d& noise);

}  // namespace racecar_mcl
