// Odometry motion models with additive Gaussian noise (report, section 2.1; Probabilistic Robotics,
// section 5.4).
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/motion/odometry_buffer.h"

namespace racecar_mcl {

enum class MotionNoise {
  kConstant,      ///< the report's: fixed sigmas per odometry message
  kDifferential,  ///< Probabilistic Robotics, table 5.6: turn, drive, turn
  kAckermann,     ///< for cars: variances grow with distance, turn, time in motion and slip
};

struct MotionModelParameters {
  MotionNoise motion_model = MotionNoise::kAckermann;
  bool deterministic = false;  ///< no noise at all

  // constant (report, section 2.1: 0.04 m, 0.04 m, 0.03 rad), per odometry message
  double constant_x_sigma = 0.04;    ///< m
  double constant_y_sigma = 0.04;    ///< m
  double constant_yaw_sigma = 0.03;  ///< rad

  // differential (alpha 1 to 4 of Probabilistic Robotics, as sigmas)
  double rotation_noise_from_rotation = 0.2;        ///< rad per rad
  double rotation_noise_from_translation = 0.05;    ///< rad per m
  double translation_noise_from_translation = 0.1;  ///< m per m
  double translation_noise_from_rotation = 0.02;    ///< m per rad

  // ackermann, white noise: variances grow with the distance, independent of the rate of scans
  double longitudinal_noise_from_translation = 0.01;  ///< m per sqrt(m), along the car
  double lateral_noise_from_translation = 0.012;      ///< m per sqrt(m), sideways
  double yaw_noise_from_translation = 0.04;           ///< rad per sqrt(m)
  double yaw_noise_from_rotation = 0.3;               ///< rad per sqrt(rad)
  double position_noise_from_time = 0.009;            ///< m per sqrt(s), while moving
  double yaw_noise_from_time = 0.016;                 ///< rad per sqrt(s), while moving
  /// Along, m per sqrt(m) and per m/s of speed: wheels slip in bursts.
  double slip_noise_from_speed = 0.015;
  /// Along and across, m per sqrt(m) and per m/s^2 of lateral acceleration.
  double slip_noise_from_acceleration = 0.015;

  // ackermann, constant errors between two scans: standard deviations grow with the distance, which
  // matters if scans are far apart
  double translation_scale_error = 0.09;  ///< m per m, of the distance driven
  double curvature_error = 0.023;         ///< rad per m, unmeasured curvature
  double rotation_scale_error = 0.04;     ///< rad per rad, of the turn
};

/// Throws ParameterError on a sigma outside [0, 1000].
void validate(const MotionModelParameters& parameters);

/// The covariance (m, m, rad) of the noise of one motion, in the frame of the car at its start.
Eigen::Matrix3d motionCovariance(const MotionModelParameters& parameters, const Motion& motion);

/// Moves every particle by the motion in its own frame (report, eq. 1-3) plus an independent sample
/// of the noise (eq. 4).
void moveParticles(const MotionModelParameters& parameters, const Motion& motion, Random& random,
                   ParticleSet* particles);

}  // namespace racecar_mcl
