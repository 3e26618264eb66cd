// Particle set: structure of arrays with log weights.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/pose_batch.h"

namespace racecar_mcl {

/// N hypotheses of the car's pose in the map frame (m, m, rad) with unnormalised log weights. All
/// arrays have the same length. Likelihoods of scans reach 1e-104 and below, hence the logarithms.
struct ParticleSet {
  Eigen::ArrayXd x;
  Eigen::ArrayXd y;
  Eigen::ArrayXd yaw;
  Eigen::ArrayXd log_weight;

  Eigen::Index size() const { return x.size(); }

  void resize(Eigen::Index count) {
    x.resize(count);
    y.resize(count);
    yaw.resize(count);
    log_weight.resize(count);
  }

  Pose2 pose(Eigen::Index i) const { return {x[i], y[i], yaw[i]}; }

  void setPose(Eigen::Index i, const Pose2& pose) {
    x[i] = pose.x;
    y[i] = pose.y;
    yaw[i] = pose.yaw;
  }

  PoseBatch poses() const { return {x.data(), y.data(), yaw.data(), size()}; }
};

}  // namespace racecar_mcl
