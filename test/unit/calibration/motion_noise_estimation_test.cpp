#include "calibration/motion_noise_estimation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

/// Motions of various lengths, speeds and curvatures; the truth is a particle of the motion model.
std::vector<MotionSample> sampleModel(const MotionModelParameters& parameters, int count,
                                      Random* random) {
  std::vector<MotionSample> samples;
  for (int i = 0; i < count; ++i) {
    MotionSample sample;
    sample.seconds = random->uniform(0.05, 1.0);
    const Twist2 twist{random->uniform(0.5, 6.0), 0.0, random->uniform(-2.0, 2.0)};
    Motion& motion = sample.motion;
    motion.delta = integrate(twist, sample.seconds);
    motion.distance = twist.vx * sample.seconds;
    motion.rotation = std::abs(twist.wz) * sample.seconds;
    motion.seconds = sample.seconds;
    motion.messages = 50.0 * sample.seconds;
    ParticleSet particle;
    particle.resize(1);
    particle.x[0] = particle.y[0] = particle.yaw[0] = 0.0;
    moveParticles(parameters, motion, *random, &particle);
    sample.error << particle.x[0] - motion.delta.x, particle.y[0] - motion.delta.y,
        wrapAngle(particle.yaw[0] - motion.delta.yaw);
    samples.push_back(sample);
  }
  return samples;
}

void expectWithinTenPercent(double estimated, double truth) {
  EXPECT_NEAR(estimated, truth, 0.1 * truth);
}

TEST(FitMotionNoise, RecoversTheConstantModel) {
  Random random(1);
  MotionModelParameters truth;
  truth.motion_model = MotionNoise::kConstant;
  truth.constant_x_sigma = 0.01;
  truth.constant_y_sigma = 0.03;
  truth.constant_yaw_sigma = 0.002;
  const MotionNoiseEstimate fit =
      estimateMotionNoise(sampleModel(truth, 2000, &random), MotionNoise::kConstant,
                          noiseTerms(MotionNoise::kConstant));
  expectWithinTenPercent(fit.parameters.constant_x_sigma, 0.01);
  expectWithinTenPercent(fit.parameters.constant_y_sigma, 0.03);
  expectWithinTenPercent(fit.parameters.constant_yaw_sigma, 0.002);
}

TEST(FitMotionNoise, RecoversTheDifferentialModel) {
  Random random(2);
  MotionModelParameters truth;
  truth.motion_model = MotionNoise::kDifferential;
  const MotionNoiseEstimate fit =
      estimateMotionNoise(sampleModel(truth, 5000, &random), MotionNoise::kDifferential,
                          noiseTerms(MotionNoise::kDifferential));
  expectWithinTenPercent(fit.parameters.rotation_noise_from_rotation,
                         truth.rotation_noise_from_rotation);
  expectWithinTenPercent(fit.parameters.rotation_noise_from_translation,
                         truth.rotation_noise_from_translation);
  expectWithinTenPercent(fit.parameters.translation_noise_from_translation,
                         truth.translation_noise_from_translation);
}

TEST(FitMotionNoise, RecoversTheMainTermsOfTheAckermannModel) {
  Random random(3);
  MotionModelParameters truth;
  truth.position_noise_from_time = truth.yaw_noise_from_time = 0.0;
  truth.slip_noise_from_speed = truth.slip_noise_from_acceleration = 0.0;
  truth.longitudinal_noise_from_translation = 0.05;
  truth.lateral_noise_from_translation = 0.03;
  truth.yaw_noise_from_translation = 0.03;
  truth.yaw_noise_from_rotation = 0.12;
  truth.translation_scale_error = 0.06;
  truth.curvature_error = 0.05;
  truth.rotation_scale_error = 0.15;
  const MotionNoiseEstimate fit =
      estimateMotionNoise(sampleModel(truth, 40000, &random), MotionNoise::kAckermann,
                          {"longitudinal_noise_from_translation", "lateral_noise_from_translation",
                           "yaw_noise_from_translation", "yaw_noise_from_rotation",
                           "translation_scale_error", "curvature_error", "rotation_scale_error"});
  expectWithinTenPercent(fit.parameters.longitudinal_noise_from_translation,
                         truth.longitudinal_noise_from_translation);
  expectWithinTenPercent(fit.parameters.lateral_noise_from_translation,
                         truth.lateral_noise_from_translation);
  expectWithinTenPercent(fit.parameters.yaw_noise_from_translation,
                         truth.yaw_noise_from_translation);
  expectWithinTenPercent(fit.parameters.yaw_noise_from_rotation, truth.yaw_noise_from_rotation);
  expectWithinTenPercent(fit.parameters.translation_scale_error, truth.translation_scale_error);
  expectWithinTenPercent(fit.parameters.curvature_error, truth.curvature_error);
  expectWithinTenPercent(fit.parameters.rotation_scale_error, truth.rotation_scale_error);
  EXPECT_EQ(fit.parameters.position_noise_from_time, 0.0);
}

TEST(FitMotionNoise, FindsNoNoiseWhereThereIsNoneAndTermsThatNoMotionFeels) {
  MotionSample straight;
  straight.motion = {{1.0, 0.0, 0.0}, 1.0, 0.0, 1.0, 50.0};
  straight.seconds = 1.0;
  straight.error.setZero();
  const MotionNoiseEstimate fit =
      estimateMotionNoise(std::vector<MotionSample>(50, straight), MotionNoise::kAckermann,
                          {"longitudinal_noise_from_translation", "yaw_noise_from_rotation",
                           "translation_scale_error"});
  EXPECT_LT(fit.parameters.longitudinal_noise_from_translation, 1e-4);
  EXPECT_EQ(fit.parameters.yaw_noise_from_rotation, 0.0);
  EXPECT_NO_THROW(validate(fit.parameters));
}

TEST(FitMotionNoise, LeavesTheNoiseOfTheTrajectoryToTheTrajectory) {
  Random random(4);
  MotionModelParameters truth;
  truth.motion_model = MotionNoise::kConstant;
  truth.constant_x_sigma = truth.constant_y_sigma = truth.constant_yaw_sigma = 0.003;
  std::vector<MotionSample> samples = sampleModel(truth, 5000, &random);
  for (MotionSample& sample : samples) {
    // At both ends of a motion.
    sample.error +=
        std::sqrt(2.0) * Eigen::Vector3d(0.02 * random.gaussian(), 0.02 * random.gaussian(),
                                         0.01 * random.gaussian());
  }
  const MotionNoiseEstimate fit = estimateMotionNoise(
      samples, MotionNoise::kConstant, noiseTerms(MotionNoise::kConstant), {0.02, 0.01});
  expectWithinTenPercent(fit.parameters.constant_x_sigma, 0.003);
  expectWithinTenPercent(fit.parameters.constant_y_sigma, 0.003);
  expectWithinTenPercent(fit.parameters.constant_yaw_sigma, 0.003);
}

TEST(FitMotionNoise, RefusesUnknownTermsBadNoiseAndNoMotion) {
  Random random(5);
  const std::vector<MotionSample> samples = sampleModel({}, 10, &random);
  EXPECT_THROW(estimateMotionNoise(samples, MotionNoise::kAckermann, {"constant_x_sigma"}),
               ParameterError);
  EXPECT_THROW(
      estimateMotionNoise(samples, MotionNoise::kConstant, {"constant_x_sigma"}, {0.0, 0.01}),
      ParameterError);
  EXPECT_THROW(estimateMotionNoise({}, MotionNoise::kConstant, {"constant_x_sigma"}),
               std::invalid_argument);
}

/// A drive on an arc at 2 m/s; odometry at 50 Hz is 10 % too fast.
MotionSampler drive(const Trajectory& truth, const std::function<bool(double)>& hears) {
  MotionSampler sampler(truth, {}, 0.5);
  for (int tick = 0; tick <= 200; ++tick) {
    const double seconds = 0.02 * tick;
    if (!hears(seconds)) continue;
    sampler.add({100.0 + seconds, {2.2, 0.0, 0.5}, {}}, std::llround((100.0 + seconds) * 1e9));
  }
  return sampler;
}

Trajectory arc() {
  Trajectory truth;
  for (int tick = 0; tick <= 400; ++tick) {
    const double seconds = 0.01 * tick;
    truth.push_back({std::llround((100.0 + seconds) * 1e9),
                     compose({3.0, 1.0, 2.0}, integrate({2.0, 0.0, 0.5}, seconds))});
  }
  return truth;
}

TEST(MotionSampler, ComparesOdometryWithTheTrajectoryInTheCarsFrame) {
  const Trajectory truth = arc();
  const MotionSampler sampler = drive(truth, [](double) { return true; });
  const std::vector<MotionSample> samples = sampler.samples(0.5);
  ASSERT_GE(samples.size(), 6u);
  const Pose2 real = integrate({2.0, 0.0, 0.5}, 0.5);
  const Pose2 told = integrate({2.2, 0.0, 0.5}, 0.5);
  for (const MotionSample& sample : samples) {
    EXPECT_NEAR(sample.error.x(), real.x - told.x, 1e-4);
    EXPECT_NEAR(sample.error.y(), real.y - told.y, 1e-4);
    EXPECT_NEAR(sample.error.z(), 0.0, 1e-6);
    EXPECT_NEAR(sample.motion.messages, 25.0, 1e-3);
  }
}

TEST(MotionSampler, LeavesOutGapsOfOdometryAndTrajectory) {
  const Trajectory truth = arc();
  const std::size_t whole = drive(truth, [](double) { return true; }).samples(0.2).size();
  const MotionSampler deaf = drive(truth, [](double t) { return t < 1.0 || t > 2.5; });
  EXPECT_LT(deaf.samples(0.2).size(), whole - 6);
  Trajectory torn = truth;
  torn.erase(torn.begin() + 100, torn.begin() + 250);
  EXPECT_LT(drive(torn, [](double) { return true; }).samples(0.2).size(), whole - 6);
}

TEST(MotionSampler, FindsNothingWhereTimesDoNotMeet) {
  Trajectory later = arc();
  for (StampedPose& row : later) row.stamp += 1000000000000;
  EXPECT_TRUE(drive(later, [](double) { return true; }).samples(0.2).empty());
}

}  // namespace
}  // namespace racecar_mcl
