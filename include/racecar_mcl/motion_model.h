// Motion model: the car's motion from odometry, plus noise, applied to every particle (report,
// section 2.1).
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/odometry.h"
#include "racecar_mcl/particles.h"
#include "racecar_mcl/random.h"

namespace racecar_mcl {

enum class MotionNoise {
  kConstant,      ///< the report's: fixed sigmas per odometry message
  kDifferential,  ///< Probabilistic Robotics, table 5.6: turn, drive, turn
  kAckermann,     ///< a car's: variance grows with the distance driven, the turn, the time spent
                  ///< moving, and slip
};

struct MotionModelParameters {
  MotionNoise motion_model = MotionNoise::kAckermann;
  bool deterministic = false;  ///< no noise at all

  // constant (report, section 2.1: 0.04 m, 0.04 m, 0.03 rad), per odometry message
  double constant_x_sigma = 0.04;    ///< m
  double constant_y_sigma = 0.04;    ///< m
  double constant_yaw_sigma = 0.03;  ///< rad

  // differential (alpha 1 to 4 of Probabilistic Robotics, as sigmas)
  double turn_per_turn = 0.2;    ///< rad per rad
  double turn_per_metre = 0.05;  ///< rad per m
  double drive_per_metre = 0.1;  ///< m per m
  double drive_per_turn = 0.02;  ///< m per rad

  // ackermann, what is independent from metre to metre: the spread after a metre does not depend on
  // how often scans come
  double along_per_metre = 0.01;         ///< m per sqrt(m), along the car
  double across_per_metre = 0.012;       ///< m per sqrt(m), sideways
  double yaw_per_metre = 0.04;           ///< rad per sqrt(m)
  double yaw_per_radian = 0.3;           ///< rad per sqrt(rad)
  double position_per_second = 0.009;    ///< m per sqrt(s), while moving
  double yaw_per_second = 0.016;         ///< rad per sqrt(s), while moving
  double slip_per_acceleration = 0.015;  ///< m per sqrt(m) and m/s^2 sideways; along and sideways

  // ackermann, what stays the same between two scans: it counts where scans are far apart
  double scale_error = 0.09;       ///< m per m, of the distance driven
  double curvature_error = 0.023;  ///< rad per m, a bend that the odometry does not see
  double turn_scale_error = 0.04;  ///< rad per rad, of the turn
};

/// Throws ParameterError on a sigma outside [0, 1000].
void validate(const MotionModelParameters& parameters);

/// The noise of one motion in the frame of the car at its start: a zero-mean Gaussian on (x, y,
/// yaw).
Eigen::Matrix3d motionCovariance(const MotionModelParameters& parameters, const Motion& motion);

/// Moves every particle by the motion, turned into the map by the particle's own yaw (report, eq.
/// 1-3), plus an independent sample of the noise (eq. 4).
void moveParticles(const MotionModelParameters& parameters, const Motion& motion, Random& random,
                   ParticleSet* particles);

}  // namespace racecar_mcl
