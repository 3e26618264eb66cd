// Adaptation of the motion noise by the normalised innovation squared (NIS) of corrections by
// scans.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {

/// If the motion model is right, corrections are independent, with the covariance of its noise.
/// Slip, blocked wheels and wrong scales make successive corrections add up. The NIS of their
/// fading sum then exceeds a threshold, and the noise is scaled up until the particles follow the
/// corrections.
class ProcessNoiseAdaptation {
 public:
  /// Adds the correction by one scan. `correction`: the estimate in the frame of the predicted
  /// pose; `noise`: the motion model's covariance (m, m, rad) of the motion since the last scan;
  /// `seconds`: time in motion since then.
  void learn(const Pose2& correction, const Eigen::Matrix3d& noise, double seconds);

  /// Factor on the standard deviations of the motion noise; 1 if the NIS is below the threshold.
  double noiseScale() const;

  void reset() { *this = ProcessNoiseAdaptation(); }

 private:
  Eigen::Vector3d correction_ = Eigen::Vector3d::Zero();  ///< m, m, rad; fading sum
  Eigen::Matrix3d noise_ = Eigen::Matrix3d::Zero();       ///< expected covariance of the sum
};

}  // namespace racecar_mcl
