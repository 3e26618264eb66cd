#include "racecar_mcl/motion/motion_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/scalars.h"
#include "racecar_mcl/common/validation.h"
#include "simd/normal_generator.h"

namespace racecar_mcl {
namespace {

// A motion that moves for a shorter time has no lateral acceleration: the time is a difference of
// sums, and a car that creeps below the speeds of a stationary one has none but its rounding error.
constexpr double kMinMovingTime = 1e-3;  // s

// Below this translation, the direction of a motion is undefined: a turn in place.
constexpr double kMinTranslation = 1e-3;  // m

Eigen::Matrix3d constantNoise(const MotionModelParameters& p, const Motion& motion) {
  const Eigen::Vector3d per_message(square(p.constant_x_sigma), square(p.constant_y_sigma),
                                    square(p.constant_yaw_sigma));
  return (per_message * motion.messages).asDiagonal();
}

/// Rotation, translation, rotation (Probabilistic Robotics, section 5.4), linearised about the
/// motion. Reverse driving is a negative translation, not two half turns.
Eigen::Matrix3d differentialNoise(const MotionModelParameters& p, const Motion& motion) {
  const Pose2& d = motion.delta;
  const double drive = std::hypot(d.x, d.y);
  double first_turn = drive < kMinTranslation ? 0.0 : std::atan2(d.y, d.x);
  const bool backwards = std::abs(first_turn) > kPi / 2;
  if (backwards) first_turn = wrapAngle(first_turn - kPi);
  const double second_turn = wrapAngle(d.yaw - first_turn);
  const auto turnVariance = [&](double turn) {
    return square(p.rotation_noise_from_rotation * turn) +
           square(p.rotation_noise_from_translation * drive);
  };
  const double first_variance = turnVariance(first_turn);
  const double second_variance = turnVariance(second_turn);
  const double drive_variance =
      square(p.translation_noise_from_translation * drive) +
      square(p.translation_noise_from_rotation) * (square(first_turn) + square(second_turn));

  const double signed_drive = backwards ? -drive : drive;
  const double c = std::cos(first_turn);
  const double s = std::sin(first_turn);
  Eigen::Matrix3d jacobian;  // of (x, y, yaw) by (first turn, drive, second turn)
  jacobian << -signed_drive * s, c, 0.0, signed_drive * c, s, 0.0, 1.0, 0.0, 1.0;
  return jacobian * Eigen::Vector3d(first_variance, drive_variance, second_variance).asDiagonal() *
         jacobian.transpose();
}

/// A random walk of the heading over a length L gives var(y) = L^2/3 and cov(y, yaw) = L/2 times
/// the variance of the yaw. A constant drift of the heading gives an arc: y is L/2 times the final
/// yaw.
Eigen::Matrix3d ackermannNoise(const MotionModelParameters& p, const Motion& motion) {
  const double walk = square(p.yaw_noise_from_translation) * motion.distance +
                      square(p.yaw_noise_from_rotation) * motion.rotation +
                      square(p.yaw_noise_from_time) * motion.seconds;
  const double drift = square(p.curvature_error * motion.distance) +
                       square(p.rotation_scale_error * motion.delta.yaw);
  const bool moves = motion.seconds > kMinMovingTime;
  const double speed = moves ? motion.distance / motion.seconds : 0.0;
  const double turn_rate = moves ? motion.rotation / motion.seconds : 0.0;
  const double slip = square(p.slip_noise_from_acceleration * speed * turn_rate) * motion.distance;
  const double wheel_slip = square(p.slip_noise_from_speed * speed) * motion.distance;
  const double from_time = square(p.position_noise_from_time) * motion.seconds;
  const double length = motion.delta.x;

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(0, 0) = square(p.longitudinal_noise_from_translation) * motion.distance + slip +
                     wheel_slip + from_time + square(p.translation_scale_error * length);
  covariance(1, 1) = square(p.lateral_noise_from_translation) * motion.distance + slip + from_time +
                     walk * square(length) / 3.0 + drift * square(length) / 4.0;
  covariance(1, 2) = covariance(2, 1) = (walk + drift) * length / 2.0;
  covariance(2, 2) = walk + drift;
  return covariance;
}

Eigen::Matrix3d modelCovariance(const MotionModelParameters& parameters, const Motion& motion) {
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

/// A motion that is applied to all particles.
struct Step {
  Pose2 delta;
  Eigen::Matrix3d root;  ///< matrix square root of the noise's covariance; zero = no noise
  std::uint64_t noise_seed;
};

RACECAR_MCL_INLINE void moveAll(const Step& step, int size, double* __restrict x,
                                double* __restrict y, double* __restrict yaw) {
  static_assert(kBlockSize % NoiseLanes::kBatch == 0, "a block is a number of whole batches");
  alignas(64) double a[kBlockSize] = {}, b[kBlockSize] = {}, d[kBlockSize] = {};
  NoiseLanes random(step.noise_seed);
  const bool noisy = !step.root.isZero(0.0);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_rows = step.root;
  const double* const root = by_rows.data();
  for (int first = 0; first < size; first += kBlockSize) {
    const int count = std::min(kBlockSize, size - first);
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
      {"rotation_noise_from_rotation", p.rotation_noise_from_rotation},
      {"rotation_noise_from_translation", p.rotation_noise_from_translation},
      {"translation_noise_from_translation", p.translation_noise_from_translation},
      {"translation_noise_from_rotation", p.translation_noise_from_rotation},
      {"longitudinal_noise_from_translation", p.longitudinal_noise_from_translation},
      {"lateral_noise_from_translation", p.lateral_noise_from_translation},
      {"yaw_noise_from_translation", p.yaw_noise_from_translation},
      {"yaw_noise_from_rotation", p.yaw_noise_from_rotation},
      {"position_noise_from_time", p.position_noise_from_time},
      {"yaw_noise_from_time", p.yaw_noise_from_time},
      {"slip_noise_from_speed", p.slip_noise_from_speed},
      {"slip_noise_from_acceleration", p.slip_noise_from_acceleration},
      {"translation_scale_error", p.translation_scale_error},
      {"curvature_error", p.curvature_error},
      {"rotation_scale_error", p.rotation_scale_error}};
  for (const auto& [name, value] : sigmas) requireWithin(name, value, 0.0, 1000.0);
}

Eigen::Matrix3d motionCovariance(const MotionModelParameters& parameters, const Motion& motion) {
  if (parameters.deterministic) return Eigen::Matrix3d::Zero();
  if (motion.covariance) return *motion.covariance;
  Eigen::Matrix3d covariance = square(motion.noise_scale) * modelCovariance(parameters, motion);
  covariance(0, 0) += motion.scale_variance;
  return covariance;
}

void moveParticles(const MotionModelParameters& parameters, const Motion& motion, Random& random,
                   ParticleSet* particles) {
  const Eigen::Matrix3d covariance = motionCovariance(parameters, motion);
  Step step{motion.delta, Eigen::Matrix3d::Zero(), 0};
  if (!covariance.isZero(0.0)) {
    // LDLT also factorizes singular covariances, as of a turn in place.
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
