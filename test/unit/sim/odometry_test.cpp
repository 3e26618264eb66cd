#include "sim/odometry.h"

#include <gtest/gtest.h>

#include <vector>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl::sim {
namespace {

const Twist2 kTrueTwist{3.0, 0.0, 0.5};

OdometryParameters perfect() {
  OdometryParameters parameters;
  parameters.noise = {0.0, 0.0, 0.0};
  parameters.speed_scale_error = 0.0;
  parameters.rotation_scale_error = 0.0;
  return parameters;
}

std::vector<OdometrySample> drive(const OdometryParameters& parameters, double seconds,
                                  std::uint64_t seed = 1) {
  WheelOdometry odometry(parameters, seed, 0.0);
  std::vector<OdometrySample> samples;
  for (int tick = 0; tick < static_cast<int>(seconds * 1000.0); ++tick) {
    const Pose2 base_in_map = integrate(kTrueTwist, tick * 1e-3);
    const auto sample =
        odometry.measure({tick * 1e-3, (tick + 1) * 1e-3, base_in_map, kTrueTwist}, kTrueTwist.wz);
    if (sample) samples.push_back(*sample);
  }
  return samples;
}

struct Statistics {
  double mean = 0.0;
  double sigma = 0.0;
};

template <typename Value>
Statistics statistics(const std::vector<OdometrySample>& samples, Value&& value) {
  Statistics result;
  for (const auto& sample : samples) result.mean += value(sample);
  result.mean /= static_cast<double>(samples.size());
  for (const auto& sample : samples) result.sigma += std::pow(value(sample) - result.mean, 2);
  result.sigma = std::sqrt(result.sigma / static_cast<double>(samples.size()));
  return result;
}

TEST(WheelOdometry, PerfectWheelsTellTheTruth) {
  const auto samples = drive(perfect(), 2.0);
  ASSERT_EQ(samples.size(), 100u);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples[i].stamp, 0.02 * static_cast<double>(i), 1e-12);
    EXPECT_EQ(samples[i].twist.vx, 3.0);
    const Pose2 truth = integrate(kTrueTwist, samples[i].stamp);
    EXPECT_NEAR(distance(samples[i].base_in_odom, truth), 0.0, 1e-9);
  }
}

TEST(WheelOdometry, NoiseHasItsSigmaAndErrorsTheirSize) {
  OdometryParameters parameters = perfect();
  parameters.noise = {0.1, 0.05, 0.2};
  parameters.speed_scale_error = 0.02;
  parameters.rotation_scale_error = -0.04;
  parameters.speed_bias = 0.05;
  parameters.turn_bias = 0.01;
  const auto samples = drive(parameters, 400.0);
  const Statistics vx = statistics(samples, [](const auto& s) { return s.twist.vx; });
  const Statistics vy = statistics(samples, [](const auto& s) { return s.twist.vy; });
  const Statistics wz = statistics(samples, [](const auto& s) { return s.twist.wz; });
  EXPECT_NEAR(vx.sigma, 0.1, 0.003);
  EXPECT_NEAR(vy.sigma, 0.05, 0.0015);
  EXPECT_NEAR(wz.sigma, 0.2, 0.006);
  EXPECT_NEAR(vx.mean, 3.0 * 1.02 + 0.05, 0.003);
  EXPECT_NEAR(vy.mean, 0.0, 0.0015);
  EXPECT_NEAR(wz.mean, 0.5 * 0.96 + 0.01, 0.006);
}

TEST(WheelOdometry, SlipComesInBurstsOfItsSizeAndLength) {
  OdometryParameters parameters = perfect();
  parameters.slip = 0.15;
  const auto samples = drive(parameters, 2000.0);
  int bursts = 0;
  int high = 0;
  int low = 0;
  double before = 3.0;
  for (const auto& sample : samples) {
    const double speed = sample.twist.vx;
    const bool slips = std::abs(speed - 3.0) > 1e-9;
    EXPECT_NEAR(std::abs(speed - 3.0), slips ? 0.45 : 0.0, 1e-9);
    EXPECT_NEAR(sample.twist.wz, 0.5 * speed / 3.0, 1e-9);
    bursts += slips && speed != before ? 1 : 0;
    high += speed > 3.1 ? 1 : 0;
    low += speed < 2.9 ? 1 : 0;
    before = speed;
  }
  // On average 2 s between bursts of 0.4 s.
  EXPECT_NEAR(bursts, 2000.0 / 2.4, 100.0);
  EXPECT_NEAR((high + low) / static_cast<double>(samples.size()), 0.4 / 2.4, 0.02);
  EXPECT_NEAR(high / static_cast<double>(high + low), 0.5, 0.1);
}

TEST(WheelOdometry, LostMessagesLeaveTheSummedUpPoseWhole) {
  OdometryParameters parameters = perfect();
  parameters.dropout_rate = 0.1;
  const auto samples = drive(parameters, 100.0);
  EXPECT_NEAR(static_cast<double>(samples.size()), 4500.0, 80.0);
  for (const auto& sample : samples) {
    EXPECT_NEAR(distance(sample.base_in_odom, integrate(kTrueTwist, sample.stamp)), 0.0, 1e-6);
  }
}

TEST(WheelOdometry, AParameterChangesItsOwnEffectOnly) {
  const OdometryParameters plain;
  OdometryParameters slippery = plain;
  slippery.slip = 0.2;
  const auto a = drive(plain, 20.0);
  const auto b = drive(slippery, 20.0);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].twist.vy, b[i].twist.vy);
}

TEST(WheelOdometry, RefusesWhatCannotBe) {
  OdometryParameters parameters;
  parameters.noise.vy = -0.1;
  EXPECT_THROW(parameters.validate(), ParameterError);
  parameters = {};
  parameters.rate = 0.0;
  EXPECT_THROW(parameters.validate(), ParameterError);
  parameters = {};
  parameters.dropout_rate = 2.0;
  EXPECT_THROW(parameters.validate(), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
