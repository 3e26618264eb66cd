#include "racecar_mcl/motion/motion_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "support/statistics.h"

namespace racecar_mcl {
namespace {

constexpr Eigen::Index kMany = 20000;

ParticleSet setAt(const Pose2& pose, Eigen::Index count) {
  ParticleSet particles;
  particles.resize(count);
  particles.x.setConstant(pose.x);
  particles.y.setConstant(pose.y);
  particles.yaw.setConstant(pose.yaw);
  particles.log_weight.setConstant(-std::log(static_cast<double>(count)));
  return particles;
}

/// The motion with a constant twist, integrated in `messages` messages.
Motion motionOf(const Twist2& twist, double seconds, double messages = 1.0) {
  return {integrate(twist, seconds), std::hypot(twist.vx, twist.vy) * seconds,
          std::abs(twist.wz) * seconds, seconds, messages};
}

MotionModelParameters noise(MotionNoise model) {
  MotionModelParameters parameters;
  parameters.motion_model = model;
  return parameters;
}

/// Ackermann noise without constant errors.
MotionModelParameters independentNoise() {
  MotionModelParameters parameters = noise(MotionNoise::kAckermann);
  parameters.translation_scale_error = parameters.curvature_error =
      parameters.rotation_scale_error = 0.0;
  return parameters;
}

/// Zero noise; tests set single parameters.
MotionModelParameters quiet() {
  MotionModelParameters parameters = independentNoise();
  parameters.longitudinal_noise_from_translation = parameters.lateral_noise_from_translation = 0.0;
  parameters.yaw_noise_from_translation = parameters.yaw_noise_from_rotation = 0.0;
  parameters.position_noise_from_time = parameters.yaw_noise_from_time = 0.0;
  parameters.slip_noise_from_acceleration = 0.0;
  return parameters;
}

MotionModelParameters deterministic() {
  MotionModelParameters parameters;
  parameters.deterministic = true;
  return parameters;
}

/// Compares sample covariances, with tolerances of five standard deviations.
void expectCovariance(const Eigen::Matrix3d& measured, const Eigen::Matrix3d& expected,
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

TEST(MotionModel, RotatesTheMotionByEachParticlesYaw) {
  ParticleSet particles;
  particles.resize(3);
  particles.setPose(0, {1.0, 2.0, 0.0});
  particles.setPose(1, {1.0, 2.0, kPi / 2});
  particles.setPose(2, {0.0, 0.0, kPi / 6});
  Random random(1);
  moveParticles(deterministic(), {{0.2, -0.05, 0.1}, 0.2, 0.1, 0.1, 1.0}, random, &particles);
  // Report, eq. 2, by hand.
  EXPECT_NEAR(particles.x[0], 1.2, 1e-12);
  EXPECT_NEAR(particles.y[0], 1.95, 1e-12);
  EXPECT_NEAR(particles.x[1], 1.05, 1e-12);
  EXPECT_NEAR(particles.y[1], 2.2, 1e-12);
  EXPECT_NEAR(particles.x[2], 0.2 * std::sqrt(3.0) / 2 + 0.05 / 2, 1e-12);
  EXPECT_NEAR(particles.y[2], 0.2 / 2 - 0.05 * std::sqrt(3.0) / 2, 1e-12);
  EXPECT_NEAR(particles.yaw[0], 0.1, 1e-12);
  EXPECT_NEAR(particles.yaw[1], kPi / 2 + 0.1, 1e-12);
}

TEST(MotionModel, KeepsYawWithinOneTurn) {
  ParticleSet particles = setAt({0.0, 0.0, 3.1}, 1);
  Random random(1);
  moveParticles(deterministic(), {{0.0, 0.0, 0.2}, 0.0, 0.2, 0.1, 1.0}, random, &particles);
  EXPECT_NEAR(particles.yaw[0], 3.3 - 2 * kPi, 1e-12);
}

TEST(MotionModel, LeavesTheWeightsAlone) {
  ParticleSet particles = setAt({}, 5);
  particles.log_weight << -1.0, -2.0, -3.0, -4.0, -5.0;
  const Eigen::ArrayXd before = particles.log_weight;
  Random random(1);
  moveParticles({}, motionOf({1.0, 0.0, 0.3}, 0.1), random, &particles);
  EXPECT_TRUE((particles.log_weight == before).all());
}

TEST(MotionModel, DeterministicAddsNothing) {
  for (const MotionNoise model :
       {MotionNoise::kConstant, MotionNoise::kDifferential, MotionNoise::kAckermann}) {
    MotionModelParameters parameters = noise(model);
    parameters.deterministic = true;
    const Motion motion = motionOf({3.0, 0.1, 0.7}, 0.2);
    EXPECT_TRUE(motionCovariance(parameters, motion).isZero(0.0));
    ParticleSet particles = setAt({1.0, 2.0, 0.5}, 50);
    Random random(1);
    moveParticles(parameters, motion, random, &particles);
    const Pose2 expected = compose({1.0, 2.0, 0.5}, motion.delta);
    EXPECT_TRUE(((particles.x - expected.x).abs() < 1e-12).all());
    EXPECT_TRUE(((particles.y - expected.y).abs() < 1e-12).all());
    EXPECT_TRUE(((particles.yaw - expected.yaw).abs() < 1e-12).all());
  }
}

TEST(MotionModel, OneSeedGivesOneResult) {
  ParticleSet a = setAt({}, 100), b = setAt({}, 100), c = setAt({}, 100);
  Random first(5), second(5), other(6);
  const Motion motion = motionOf({3.0, 0.0, 0.7}, 0.2);
  moveParticles({}, motion, first, &a);
  moveParticles({}, motion, second, &b);
  moveParticles({}, motion, other, &c);
  EXPECT_TRUE((a.x == b.x && a.y == b.y && a.yaw == b.yaw).all());
  EXPECT_FALSE((a.x == c.x).any());
}

class NoisyMotion : public testing::TestWithParam<MotionNoise> {};

TEST_P(NoisyMotion, SamplesTheCovariance) {
  const Motion motions[] = {motionOf({3.0, 0.0, 0.8}, 0.025), motionOf({-2.0, 0.0, 0.5}, 0.1),
                            motionOf({7.0, 0.4, -3.0}, 0.05, 2.5), motionOf({0.0, 0.0, 2.0}, 0.1),
                            motionOf({0.0, 1.0, 0.0}, 0.1)};
  Random random(11);
  for (const Motion& motion : motions) {
    // At yaw 0 the frame of the car before the motion is the map's.
    ParticleSet particles = setAt({}, kMany);
    moveParticles(noise(GetParam()), motion, random, &particles);
    const SetMoments moments = momentsOf(particles);
    const Eigen::Matrix3d expected = motionCovariance(noise(GetParam()), motion);
    expectCovariance(moments.covariance, expected, kMany);
    EXPECT_NEAR(moments.mean.x(), motion.delta.x, 5 * std::sqrt(expected(0, 0) / kMany) + 1e-12);
    EXPECT_NEAR(moments.mean.y(), motion.delta.y, 5 * std::sqrt(expected(1, 1) / kMany) + 1e-12);
    EXPECT_NEAR(moments.mean.z(), motion.delta.yaw, 5 * std::sqrt(expected(2, 2) / kMany) + 1e-12);
  }
}

TEST_P(NoisyMotion, RotatesTheNoiseWithTheCar) {
  MotionModelParameters parameters = noise(GetParam());
  parameters.constant_x_sigma = 0.1;
  const Motion motion = motionOf({2.0, 0.0, 0.0}, 0.5);
  const Eigen::Matrix3d in_car = motionCovariance(parameters, motion);
  ParticleSet particles = setAt({0.0, 0.0, kPi / 2}, kMany);
  Random random(12);
  moveParticles(parameters, motion, random, &particles);
  const Eigen::Matrix3d in_map = momentsOf(particles).covariance;
  EXPECT_NEAR(in_map(1, 1), in_car(0, 0), varianceTolerance(kMany) * in_car(0, 0));
  EXPECT_NEAR(in_map(0, 0), in_car(1, 1), varianceTolerance(kMany) * in_car(1, 1));
}

TEST_P(NoisyMotion, IsAlwaysACovariance) {
  Random random(13);
  for (int i = 0; i < 2000; ++i) {
    const Twist2 twist{random.uniform(-10, 10), random.uniform(-2, 2), random.uniform(-9, 9)};
    const Eigen::Matrix3d covariance =
        motionCovariance(noise(GetParam()), motionOf(twist, random.uniform(0.0, 0.5)));
    EXPECT_TRUE(covariance.isApprox(covariance.transpose()));
    EXPECT_GE(covariance.eigenvalues().real().minCoeff(), -1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, NoisyMotion,
                         testing::Values(MotionNoise::kConstant, MotionNoise::kDifferential,
                                         MotionNoise::kAckermann));

TEST_P(NoisyMotion, UsesTheCovarianceOfTheMotionIfGiven) {
  Motion motion = motionOf({2.0, 0.0, 0.5}, 0.5);
  motion.noise_scale = 3.0;
  Eigen::Matrix3d known = Eigen::Vector3d(1e-4, 4e-4, 1e-5).asDiagonal();
  known(0, 1) = known(1, 0) = 1e-4;
  motion.covariance = known;
  EXPECT_EQ(motionCovariance(noise(GetParam()), motion), known);
  Random random(5);
  ParticleSet particles = setAt({0.0, 0.0, 0.0}, kMany);
  moveParticles(noise(GetParam()), motion, random, &particles);
  const Eigen::Matrix3d spread = momentsOf(particles).covariance;
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(spread(i, i), known(i, i), varianceTolerance(kMany) * known(i, i)) << i;
  }
  EXPECT_NEAR(spread(0, 1), known(0, 1), 1e-5);
}

TEST(ConstantNoise, IsTheReportsPerMessage) {
  MotionModelParameters parameters = noise(MotionNoise::kConstant);
  parameters.constant_x_sigma = 0.04;
  parameters.constant_y_sigma = 0.04;
  parameters.constant_yaw_sigma = 0.03;
  for (const double messages : {1.0, 3.0, 0.5}) {
    ParticleSet particles = setAt({}, kMany);
    Random random(14);
    moveParticles(parameters, motionOf({1.0, 0.0, 0.0}, 0.02, messages), random, &particles);
    const Eigen::Vector3d variances(0.04 * 0.04, 0.04 * 0.04, 0.03 * 0.03);
    expectCovariance(momentsOf(particles).covariance, (messages * variances).asDiagonal(), kMany);
  }
}

TEST(AckermannNoise, IsZeroWhileStationary) {
  ParticleSet particles = setAt({1.0, 2.0, 0.5}, 100);
  Random random(15);
  for (int i = 0; i < 1000; ++i) {
    moveParticles(noise(MotionNoise::kAckermann), {{}, 0.0, 0.0, 0.0, 1.0}, random, &particles);
  }
  EXPECT_TRUE((particles.x == 1.0 && particles.y == 2.0 && particles.yaw == 0.5).all());
}

TEST(AckermannNoise, DoesNotDependOnTheRateOfMessages) {
  // A curve of two metres in 4 and in 100 steps.
  const Twist2 twist{2.0, 0.0, 0.6};
  Eigen::Matrix3d covariances[2];
  const int steps[] = {4, 100};
  for (int run = 0; run < 2; ++run) {
    ParticleSet particles = setAt({}, kMany);
    Random random(16);
    for (int i = 0; i < steps[run]; ++i) {
      moveParticles(independentNoise(), motionOf(twist, 1.0 / steps[run]), random, &particles);
    }
    covariances[run] = momentsOf(particles).covariance;
  }
  for (int i = 0; i < 3; ++i) {
    const double both = 2 * varianceTolerance(kMany) + 0.03;  // 0.03: an arc is not its chord
    EXPECT_NEAR(covariances[0](i, i) / covariances[1](i, i), 1.0, both) << "axis " << i;
  }
}

TEST(AckermannNoise, ARandomWalkOfTheHeadingMovesThePositionSideways) {
  // Random walk of the heading only, sigma^2 = 0.01 a metre; after L = 3 m: yaw L, y L^3/3, both
  // L^2/2.
  MotionModelParameters parameters = quiet();
  parameters.yaw_noise_from_translation = 0.1;
  const Eigen::Matrix3d at_once = motionCovariance(parameters, motionOf({3.0, 0.0, 0.0}, 1.0));
  EXPECT_NEAR(at_once(2, 2), 0.01 * 3.0, 1e-12);
  EXPECT_NEAR(at_once(1, 1), 0.01 * 9.0, 1e-12);
  EXPECT_NEAR(at_once(1, 2), 0.01 * 4.5, 1e-12);
  EXPECT_NEAR(at_once(0, 0), 0.0, 1e-12);

  parameters.yaw_noise_from_translation = 0.02;  // small, so that the path stays almost straight
  ParticleSet particles = setAt({}, kMany);
  Random random(17);
  for (int i = 0; i < 300; ++i) {
    moveParticles(parameters, motionOf({3.0, 0.0, 0.0}, 1.0 / 300), random, &particles);
  }
  const Eigen::Matrix3d in_steps = momentsOf(particles).covariance;
  EXPECT_NEAR(in_steps(1, 1) / (4e-4 * 9.0), 1.0, 0.06);
  EXPECT_NEAR(in_steps(1, 2) / (4e-4 * 4.5), 1.0, 0.06);
}

TEST(AckermannNoise, TheCorrelationOfHeadingAndPositionChangesSignInReverse) {
  const Eigen::Matrix3d ahead =
      motionCovariance(noise(MotionNoise::kAckermann), motionOf({2.0, 0.0, 0.0}, 0.5));
  const Eigen::Matrix3d back =
      motionCovariance(noise(MotionNoise::kAckermann), motionOf({-2.0, 0.0, 0.0}, 0.5));
  EXPECT_GT(ahead(1, 2), 0.0);
  EXPECT_NEAR(back(1, 2), -ahead(1, 2), 1e-15);
  EXPECT_NEAR(back(1, 1), ahead(1, 1), 1e-15);
}

TEST(AckermannNoise, SlipsInFastCurves) {
  MotionModelParameters parameters = quiet();
  parameters.slip_noise_from_acceleration = 0.02;
  // A metre at 5 m/s and 2 rad/s: 10 m/s^2 sideways.
  const Eigen::Matrix3d fast = motionCovariance(parameters, motionOf({5.0, 0.0, 2.0}, 0.2));
  EXPECT_NEAR(fast(0, 0), 0.2 * 0.2, 1e-12);
  EXPECT_NEAR(fast(1, 1), 0.2 * 0.2, 1e-12);
  EXPECT_TRUE(motionCovariance(parameters, motionOf({5.0, 0.0, 0.0}, 0.2)).isZero(1e-12));
}

TEST(AckermannNoise, AConstantErrorGrowsWithTheDistanceNotItsRoot) {
  MotionModelParameters parameters = quiet();
  parameters.translation_scale_error = 0.02;
  EXPECT_NEAR(motionCovariance(parameters, motionOf({3.0, 0.0, 0.0}, 1.0))(0, 0), 0.06 * 0.06,
              1e-12);
  EXPECT_NEAR(motionCovariance(parameters, motionOf({-3.0, 0.0, 0.0}, 2.0))(0, 0), 0.12 * 0.12,
              1e-12);
  parameters = quiet();
  parameters.rotation_scale_error = 0.1;
  EXPECT_NEAR(motionCovariance(parameters, motionOf({0.0, 0.0, 2.0}, 1.0))(2, 2), 0.2 * 0.2, 1e-12);
}

TEST(AckermannNoise, AConstantCurvatureErrorIsAnArc) {
  MotionModelParameters parameters = quiet();
  parameters.curvature_error = 0.02;
  const Eigen::Matrix3d predicted = motionCovariance(parameters, motionOf({2.0, 0.0, 0.0}, 1.0));
  Random random(19);
  ParticleSet particles = setAt({}, kMany);
  for (Eigen::Index i = 0; i < kMany; ++i) {
    particles.setPose(i, integrate({2.0, 0.0, 2.0 * 0.02 * random.gaussian()}, 1.0));
  }
  const Eigen::Matrix3d sampled = momentsOf(particles).covariance;
  for (const auto& [row, column] : {std::pair{1, 1}, std::pair{1, 2}, std::pair{2, 2}}) {
    EXPECT_NEAR(predicted(row, column) / sampled(row, column), 1.0, 0.05);
  }
}

/// Probabilistic Robotics, table 5.6, by sampling.
ParticleSet sampledTurnDriveTurn(const MotionModelParameters& p, double first, double drive,
                                 double second, Random& random) {
  ParticleSet particles = setAt({}, kMany);
  for (Eigen::Index i = 0; i < kMany; ++i) {
    const auto noisyTurn = [&](double turn) {
      return turn + random.gaussian() * std::hypot(p.rotation_noise_from_rotation * turn,
                                                   p.rotation_noise_from_translation * drive);
    };
    const double a = noisyTurn(first);
    const double d =
        drive + random.gaussian() *
                    std::hypot(p.translation_noise_from_translation * drive,
                               p.translation_noise_from_rotation * std::hypot(first, second));
    const double b = noisyTurn(second);
    particles.setPose(i, {d * std::cos(a), d * std::sin(a), a + b});
  }
  return particles;
}

TEST(DifferentialNoise, IsTurnDriveTurn) {
  const MotionModelParameters parameters = noise(MotionNoise::kDifferential);
  const struct {
    double first, drive, second;
  } moves[] = {{0.0, 0.5, 0.0},  {0.1, 0.3, 0.2},  {-0.3, 0.4, 0.1},
               {0.1, -0.3, 0.2}, {0.0, -0.5, 0.0}, {0.2, -0.4, -0.3}};
  Random random(18);
  for (const auto& [first, drive, second] : moves) {
    const Pose2 delta{drive * std::cos(first), drive * std::sin(first), first + second};
    const Eigen::Matrix3d linear =
        motionCovariance(parameters, {delta, std::abs(drive), std::abs(first + second), 0.1, 1.0});
    const Eigen::Matrix3d sampled =
        momentsOf(sampledTurnDriveTurn(parameters, first, drive, second, random)).covariance;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        const double scale = std::sqrt(linear(i, i) * linear(j, j));
        EXPECT_NEAR(sampled(i, j), linear(i, j), 0.06 * scale + 1e-7)
            << "drive " << drive << " at " << i << ", " << j;
      }
    }
  }
}

TEST(DifferentialNoise, ReverseDrivingIsANegativeTranslation) {
  const MotionModelParameters parameters = noise(MotionNoise::kDifferential);
  const Eigen::Matrix3d ahead = motionCovariance(parameters, motionOf({1.0, 0.0, 0.2}, 0.1));
  const Eigen::Matrix3d back = motionCovariance(parameters, motionOf({-1.0, 0.0, 0.2}, 0.1));
  EXPECT_NEAR(back(2, 2), ahead(2, 2), 1e-12);
  EXPECT_NEAR(back(0, 0), ahead(0, 0), 1e-12);
}

TEST(DifferentialNoise, HandlesTurnsInPlaceAndStationaryCars) {
  const MotionModelParameters parameters = noise(MotionNoise::kDifferential);
  const Eigen::Matrix3d turn = motionCovariance(parameters, motionOf({0.0, 0.0, 1.0}, 0.3));
  EXPECT_NEAR(turn(2, 2), std::pow(parameters.rotation_noise_from_rotation * 0.3, 2), 1e-12);
  EXPECT_TRUE(motionCovariance(parameters, {{}, 0.0, 0.0, 0.0, 1.0}).isZero(0.0));
}

TEST(MotionModelParameters, RejectNoiseOutOfRange) {
  double MotionModelParameters::*const sigmas[] = {
      &MotionModelParameters::constant_x_sigma,
      &MotionModelParameters::constant_y_sigma,
      &MotionModelParameters::constant_yaw_sigma,
      &MotionModelParameters::rotation_noise_from_rotation,
      &MotionModelParameters::rotation_noise_from_translation,
      &MotionModelParameters::translation_noise_from_translation,
      &MotionModelParameters::translation_noise_from_rotation,
      &MotionModelParameters::longitudinal_noise_from_translation,
      &MotionModelParameters::lateral_noise_from_translation,
      &MotionModelParameters::yaw_noise_from_translation,
      &MotionModelParameters::yaw_noise_from_rotation,
      &MotionModelParameters::position_noise_from_time,
      &MotionModelParameters::yaw_noise_from_time,
      &MotionModelParameters::slip_noise_from_acceleration,
      &MotionModelParameters::translation_scale_error,
      &MotionModelParameters::curvature_error,
      &MotionModelParameters::rotation_scale_error};
  EXPECT_NO_THROW(validate(MotionModelParameters{}));
  for (const auto sigma : sigmas) {
    for (const double bad : {-0.01, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e300}) {
      MotionModelParameters parameters;
      parameters.*sigma = bad;
      EXPECT_THROW(validate(parameters), ParameterError);
    }
    MotionModelParameters none;
    none.*sigma = 0.0;
    EXPECT_NO_THROW(validate(none));
  }
}

TEST(MotionModel, ACreepingCarDoesNotSlip) {
  // 1 s below the speeds of a stationary car: the time spent moving is a rounding error.
  Motion motion = motionOf({9e-4, 0.0, 9e-4}, 1.0);
  for (const double seconds : {0.0, 1e-300, 1e-14, 1e-6}) {
    motion.seconds = seconds;
    EXPECT_LT(motionCovariance(noise(MotionNoise::kAckermann), motion).cwiseAbs().maxCoeff(), 1e-3);
  }
}

TEST(MotionModel, TheNoiseScaleIsAFactorOnAllStandardDeviations) {
  for (const MotionNoise model :
       {MotionNoise::kConstant, MotionNoise::kDifferential, MotionNoise::kAckermann}) {
    Motion motion = motionOf({3.0, 0.0, 1.0}, 0.2);
    const Eigen::Matrix3d once = motionCovariance(noise(model), motion);
    motion.noise_scale = 3.0;
    EXPECT_TRUE(motionCovariance(noise(model), motion).isApprox(9.0 * once, 1e-9));
  }
}

}  // namespace
}  // namespace racecar_mcl
