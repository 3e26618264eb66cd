// The noise of each motion model.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "support/motions.h"

namespace racecar_mcl {
namespace {

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
  parameters.slip_noise_from_speed = parameters.slip_noise_from_acceleration = 0.0;
  return parameters;
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

TEST(AckermannNoise, SlipsAlongAtSpeed) {
  MotionModelParameters parameters = quiet();
  parameters.slip_noise_from_speed = 0.02;
  for (const double speed : {1.0, 5.0}) {  // over two metres
    const Eigen::Matrix3d noise =
        motionCovariance(parameters, motionOf({speed, 0.0, 0.5}, 2.0 / speed));
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    expected(0, 0) = 0.02 * speed * 0.02 * speed * 2.0;
    EXPECT_TRUE(noise.isApprox(expected, 1e-9)) << noise;
  }
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

TEST(MotionNoise, GrowsWithTheSquareOfEveryParameter) {
  using P = MotionModelParameters;
  const std::pair<MotionNoise, std::vector<double P::*>> models[] = {
      {MotionNoise::kConstant,
       {&P::constant_x_sigma, &P::constant_y_sigma, &P::constant_yaw_sigma}},
      {MotionNoise::kDifferential,
       {&P::rotation_noise_from_rotation, &P::rotation_noise_from_translation,
        &P::translation_noise_from_translation, &P::translation_noise_from_rotation}},
      {MotionNoise::kAckermann,
       {&P::longitudinal_noise_from_translation, &P::lateral_noise_from_translation,
        &P::yaw_noise_from_translation, &P::yaw_noise_from_rotation, &P::position_noise_from_time,
        &P::yaw_noise_from_time, &P::slip_noise_from_speed, &P::slip_noise_from_acceleration,
        &P::translation_scale_error, &P::curvature_error, &P::rotation_scale_error}}};
  const Motion motion{{0.4, 0.05, 0.2}, 0.42, 0.25, 0.3, 10.0};
  for (const auto& [model, members] : models) {
    for (double P::*const member : members) {
      P parameters;
      parameters.motion_model = model;
      for (double P::*const other : members) parameters.*other = 0.0;
      parameters.*member = 0.1;
      const Eigen::Matrix3d one = motionCovariance(parameters, motion);
      EXPECT_GT(one.trace(), 0.0);
      parameters.*member = 0.2;
      EXPECT_TRUE(motionCovariance(parameters, motion).isApprox(4.0 * one, 1e-9));
    }
  }
}

}  // namespace
}  // namespace racecar_mcl
