// Motions, particle sets and noise for tests of the motion model.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "racecar_mcl/motion/motion_model.h"
#include "support/statistics.h"

namespace racecar_mcl {

constexpr Eigen::Index kMany = 20000;

inline ParticleSet setAt(const Pose2& pose, Eigen::Index count) {
  ParticleSet particles;
  particles.resize(count);
  particles.x.setConstant(pose.x);
  particles.y.setConstant(pose.y);
  particles.yaw.setConstant(pose.yaw);
  particles.log_weight.setConstant(-std::log(static_cast<double>(count)));
  return particles;
}

/// The motion with a constant twist, integrated in `messages` messages.
inline Motion motionOf(const Twist2& twist, double seconds, double messages = 1.0) {
  return {integrate(twist, seconds), std::hypot(twist.vx, twist.vy) * seconds,
          std::abs(twist.wz) * seconds, seconds, messages};
}

inline MotionModelParameters noise(MotionNoise model) {
  MotionModelParameters parameters;
  parameters.motion_model = model;
  return parameters;
}

/// Compares sample covariances, with tolerances of five standard deviations.
inline void expectCovariance(const Eigen::Matrix3d& measured, const Eigen::Matrix3d& expected,
                             double count) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(measured(i, i), expected(i, i), varianceTolerance(count) * expected(i, i) + 1e-20)
        << "variance " << i;
    for (int j = 0; j < i; ++j) {
      const double scale = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(measured(i, j), expected(i, j), 5.0 / std::sqrt(count) * scale + 1e-20)
          << "covariance " << i << ", " << j;
    }
  }
}

}  // namespace racecar_mcl
