#include "racecar_mcl/motion/motion_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "racecar_mcl/common/errors.h"
#include "support/motions.h"

namespace racecar_mcl {
namespace {

MotionModelParameters deterministic() {
  MotionModelParameters parameters;
  parameters.deterministic = true;
  return parameters;
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
    EXPECT_GE(covariance.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-12);
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
      &MotionModelParameters::slip_noise_from_speed,
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
