// Notices while driving that the odometry is off by more than the motion model allows for.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/pose.h"

namespace racecar_mcl {

/// Corrections by scans are as large as the motion noise and point anywhere while odometry is as
/// good as the motion model says. Slipping or blocked wheels and a wrong scale make them point one
/// way, and the particles, spread too little, follow none of them far enough. The noise has to grow
/// until they do.
class OdometryDoubt {
 public:
  /// What one scan said: `correction` is the pose it led to, seen from where odometry had put the
  /// car; `noise` the covariance (m, m, rad) that the motion model has for the way since the scan
  /// before, `seconds` ago.
  void learn(const Pose2& correction, const Eigen::Matrix3d& noise, double seconds);

  /// By how much the motion noise is to be multiplied, as a sigma; 1 while all is well.
  double noiseFactor() const;

  void startAgain() { *this = OdometryDoubt(); }

 private:
  Eigen::Vector3d correction_ = Eigen::Vector3d::Zero();  ///< m, m, rad; sum of late
  Eigen::Matrix3d noise_ = Eigen::Matrix3d::Zero();       ///< that the sum would have
};

}  // namespace racecar_mcl
