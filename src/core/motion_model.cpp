#include "racecar_mcl/motion_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "noise_lanes.h"
#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

double square(double value) { return value * value; }

Eigen::Matrix3d constantNoise(const MotionModelParameters& p, const Motion& motion) {
  const Eigen::Vector3d per_message(square(p.constant_x_sigma), square(p.constant_y_sigma),
                                    square(p.constant_yaw_sigma));
  return (per_message * motion.messages).asDiagonal();
}

/// Rotation, translation, rotation (Probabilistic Robotics, section 5.4), linearised about the
/// motion. Driving backwards is driving, not two half turns.
Eigen::Matrix3d differentialNoise(const MotionModelParameters& p, const Motion& motion) {
  const Pose2& d = motion.delta;
  const double drive = std::hypot(d.x, d.y);
  double first_turn = drive < 1e-3 ? 0.0 : std::atan2(d.y, d.x);
  const bool backwards = std::abs(first_turn) > kPi / 2;
  if (backwards) first_turn = wrapAngle(first_turn - kPi);
  const double second_turn = wrapAngle(d.yaw - first_turn);
  const auto turnVariance = [&](double turn) {
    return square(p.turn_per_turn * turn) + square(p.turn_per_metre * drive);
  };
  const double first_variance = turnVariance(first_turn);
  const double second_variance = turnVariance(second_turn);
  const double drive_variance =
      square(p.drive_per_metre * drive) +
      square(p.drive_per_turn) * (square(first_turn) + square(second_turn));

  const double signed_drive = backwards ? -drive : drive;
  const double c = std::cos(first_turn);
  const double s = std::sin(first_turn);
  Eigen::Matrix3d jacobian;  // of (x, y, yaw) by (first turn, drive, second turn)
  jacobian << -signed_drive * s, c, 0.0, signed_drive * c, s, 0.0, 1.0, 0.0, 1.0;
  return jacobian * Eigen::Vector3d(first_variance, drive_variance, second_variance).asDiagonal() *
         jacobian.transpose();
}

/// A heading that walks at random while the car drives a length L bends the path sideways: var(y) =
/// L^2/3 and cov(y, yaw) = L/2 times the variance of the yaw. A heading that drifts steadily bends
/// it on an arc: the sideways offset is L/2 times the final yaw.
Eigen::Matrix3d ackermannNoise(const MotionModelParameters& p, const Motion& motion) {
  const double walk = square(p.yaw_per_metre) * motion.distance +
                      square(p.yaw_per_radian) * motion.rotation +
                      square(p.yaw_per_second) * motion.seconds;
  const double drift =
      square(p.curvature_error * motion.distance) + square(p.turn_scale_error * motion.delta.yaw);
  const double speed = motion.seconds > 0.0 ? motion.distance / motion.seconds : 0.0;
  const double turn_rate = motion.seconds > 0.0 ? motion.rotation / motion.seconds : 0.0;
  const double slip = square(p.slip_per_acceleration * speed * turn_rate) * motion.distance;
  const double still = square(p.position_per_second) * motion.seconds;
  const double length = motion.delta.x;

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(0, 0) =
      square(p.along_per_metre) * motion.distance + slip + still + square(p.scale_error * length);
  covariance(1, 1) = square(p.across_per_metre) * motion.distance + slip + still +
                     walk * square(length) / 3.0 + drift * square(length) / 4.0;
  covariance(1, 2) = covariance(2, 1) = (walk + drift) * length / 2.0;
  covariance(2, 2) = walk + drift;
  return covariance;
}

Eigen::Matrix3d usualCovariance(const MotionModelParameters& parameters, const Motion& motion) {
  switch (parameters.motion_model) {
    case MotionNoise::kConstant:
      return constantNoise(parameters, motion);
    case MotionNoise::kDifferential:
      return differentialNoise(parameters, motion);
    case MotionNoise::kAckermann:
      return ackermannNoise(parameters, motion);
  }
  return Eigen::Matrix3d::Zero();
}

/// One motion for all particles.
struct Step {
  Pose2 delta;
  Eigen::Matrix3d root;  ///< of the noise's covariance; zero = no noise
  std::uint64_t noise_seed;
};

RACECAR_MCL_INLINE void moveAll(const Step& step, int size, double* __restrict x,
                                double* __restrict y, double* __restrict yaw) {
  constexpr int kBlock = 256;
  static_assert(kBlock % NoiseLanes::kBatch == 0, "whole batches are drawn");
  alignas(64) double a[kBlock] = {}, b[kBlock] = {}, d[kBlock] = {};
  NoiseLanes random(step.noise_seed);
  const bool noisy = !step.root.isZero(0.0);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_rows = step.root;
  const double* const root = by_rows.data();
  for (int first = 0; first < size; first += kBlock) {
    const int count = std::min(kBlock, size - first);
    if (noisy) {
      const int drawn = (count + NoiseLanes::kBatch - 1) / NoiseLanes::kBatch * NoiseLanes::kBatch;
      random.fillGaussian(a, drawn);
      random.fillGaussian(b, drawn);
      random.fillGaussian(d, drawn);
    }
    for (int k = 0; k < count; ++k) {
      const int i = first + k;
      const double along = step.delta.x + (root[0] * a[k] + root[1] * b[k] + root[2] * d[k]);
      const double across = step.delta.y + (root[3] * a[k] + root[4] * b[k] + root[5] * d[k]);
      const double turn = step.delta.yaw + (root[6] * a[k] + root[7] * b[k] + root[8] * d[k]);
      double sine, cosine;
      sinCos(yaw[i], &sine, &cosine);
      x[i] += cosine * along - sine * across;
      y[i] += sine * along + cosine * across;
      yaw[i] = wrapAngleFast(yaw[i] + turn);
    }
  }
}

}  // namespace

void validate(const MotionModelParameters& p) {
  const std::pair<const char*, double> sigmas[] = {
      {"constant_x_sigma", p.constant_x_sigma},
      {"constant_y_sigma", p.constant_y_sigma},
      {"constant_yaw_sigma", p.constant_yaw_sigma},
      {"turn_per_turn", p.turn_per_turn},
      {"turn_per_metre", p.turn_per_metre},
      {"drive_per_metre", p.drive_per_metre},
      {"drive_per_turn", p.drive_per_turn},
      {"along_per_metre", p.along_per_metre},
      {"across_per_metre", p.across_per_metre},
      {"yaw_per_metre", p.yaw_per_metre},
      {"yaw_per_radian", p.yaw_per_radian},
      {"position_per_second", p.position_per_second},
      {"yaw_per_second", p.yaw_per_second},
      {"slip_per_acceleration", p.slip_per_acceleration},
      {"scale_error", p.scale_error},
      {"curvature_error", p.curvature_error},
      {"turn_scale_error", p.turn_scale_error}};
  for (const auto& [name, value] : sigmas) requireWithin(name, value, 0.0, 1000.0);
}

Eigen::Matrix3d motionCovariance(const MotionModelParameters& parameters, const Motion& motion) {
  if (parameters.deterministic) return Eigen::Matrix3d::Zero();
  if (motion.covariance) return *motion.covariance;
  return square(motion.noise_factor) * usualCovariance(parameters, motion);
}

void moveParticles(const MotionModelParameters& parameters, const Motion& motion, Random& random,
                   ParticleSet* particles) {
  const Eigen::Matrix3d covariance = motionCovariance(parameters, motion);
  Step step{motion.delta, Eigen::Matrix3d::Zero(), 0};
  if (!covariance.isZero(0.0)) {
    // LDLT stands a covariance of less than full rank, as of a car that only turned.
    const Eigen::LDLT<Eigen::Matrix3d> factors(covariance);
    step.root =
        factors.transpositionsP().transpose() *
        Eigen::Matrix3d(factors.matrixL() *
                        Eigen::Matrix3d(factors.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal()));
    step.noise_seed = random();
  }
  runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
    moveAll(step, static_cast<int>(particles->size()), particles->x.data(), particles->y.data(),
            particles->yaw.data());
  });
}

}  // namespace racecar_mcl
