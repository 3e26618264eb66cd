#include "racecar_mcl/motion/process_noise_adaptation.h"

#include <gtest/gtest.h>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.025;  // s
const Eigen::Vector3d kSigma(0.01, 0.005, 0.008);
const Eigen::Matrix3d kNoise = kSigma.array().square().matrix().asDiagonal();

TEST(ProcessNoiseAdaptation, DoesNotScaleTheNoiseForIndependentCorrections) {
  ProcessNoiseAdaptation doubt;
  EXPECT_EQ(doubt.noiseScale(), 1.0);
  Random random(1);
  for (int scan = 0; scan < 2000; ++scan) {
    doubt.learn({kSigma.x() * random.gaussian(), kSigma.y() * random.gaussian(),
                 kSigma.z() * random.gaussian()},
                kNoise, kPeriod);
    EXPECT_EQ(doubt.noiseScale(), 1.0);
  }
}

TEST(ProcessNoiseAdaptation, ScalesTheNoiseForCorrelatedCorrections) {
  ProcessNoiseAdaptation doubt;
  for (int scan = 0; scan < 20; ++scan) doubt.learn({-2.0 * kSigma.x(), 0.0, 0.0}, kNoise, kPeriod);
  EXPECT_GT(doubt.noiseScale(), 2.0);
  const double at_two_sigmas = doubt.noiseScale();
  for (int scan = 0; scan < 20; ++scan) doubt.learn({-4.0 * kSigma.x(), 0.0, 0.0}, kNoise, kPeriod);
  EXPECT_NEAR(doubt.noiseScale(), 2.0 * at_two_sigmas, 0.2 * at_two_sigmas);
  for (int scan = 0; scan < 60; ++scan) doubt.learn({}, kNoise, kPeriod);
  EXPECT_EQ(doubt.noiseScale(), 1.0);
}

TEST(ProcessNoiseAdaptation, IsLimitedAndCanBeReset) {
  ProcessNoiseAdaptation doubt;
  doubt.learn({10.0, 0.0, 0.0}, Eigen::Matrix3d::Zero(), kPeriod);
  EXPECT_EQ(doubt.noiseScale(), 8.0);
  doubt.reset();
  EXPECT_EQ(doubt.noiseScale(), 1.0);
}

TEST(ProcessNoiseAdaptation, IgnoresCorrectionsBelowAMillimetreWhileStationary) {
  ProcessNoiseAdaptation doubt;
  for (int scan = 0; scan < 3; ++scan) {
    doubt.learn({5e-4, 0.0, 0.0}, Eigen::Matrix3d::Zero(), kPeriod);
  }
  EXPECT_EQ(doubt.noiseScale(), 1.0);
}

}  // namespace
}  // namespace racecar_mcl
