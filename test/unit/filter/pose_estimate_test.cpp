#include "racecar_mcl/filter/pose_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/weighted_set.h"

namespace racecar_mcl {
namespace {

TEST(WeightedMean, WeighsEachParticleByItsWeight) {
  const PoseEstimate estimate = weightedMean(
      setOf({{{0.0, 0.0, 0.1}, 0.5}, {{4.0, 0.0, 0.1}, 0.25}, {{0.0, 8.0, 0.1}, 0.25}}));
  EXPECT_NEAR(estimate.base_in_map.x, 1.0, 1e-12);
  EXPECT_NEAR(estimate.base_in_map.y, 2.0, 1e-12);
  EXPECT_NEAR(estimate.base_in_map.yaw, 0.1, 1e-12);
}

TEST(WeightedMean, AveragesYawRoundTheCircle) {
  const PoseEstimate at_pi =
      weightedMean(setOf({{{0.0, 0.0, kPi - 0.1}, 0.5}, {{0.0, 0.0, -kPi + 0.1}, 0.5}}));
  EXPECT_NEAR(std::abs(at_pi.base_in_map.yaw), kPi, 1e-12);
  EXPECT_NEAR(at_pi.covariance(2, 2), 0.01, 1e-12);
  const PoseEstimate beside_pi =
      weightedMean(setOf({{{0.0, 0.0, 3.0}, 0.75}, {{0.0, 0.0, -3.0}, 0.25}}));
  EXPECT_GT(beside_pi.base_in_map.yaw, 3.0);
  EXPECT_LT(beside_pi.base_in_map.yaw, kPi);
}

TEST(WeightedMean, IsFiniteIfYawsCancelOut) {
  const PoseEstimate estimate =
      weightedMean(setOf({{{0.0, 0.0, 0.5}, 0.5}, {{0.0, 0.0, 0.5 - kPi}, 0.5}}));
  EXPECT_NEAR(estimate.base_in_map.yaw, 0.5, 1e-12);
  EXPECT_TRUE(estimate.covariance.allFinite());
}

TEST(WeightedMean, PutsEachMomentIntoItsOwnEntry) {
  // Computed by hand: correlated offsets (+-1, +-2, +-0.1) about (5, 6, 1).
  const PoseEstimate estimate =
      weightedMean(setOf({{{6.0, 8.0, 0.9}, 0.5}, {{4.0, 4.0, 1.1}, 0.5}}));
  Eigen::Matrix3d expected;
  expected << 1.0, 2.0, -0.1, 2.0, 4.0, -0.2, -0.1, -0.2, 0.01;
  EXPECT_LT((estimate.covariance - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(WeightedMean, MeasuresTheCovarianceOfAGaussianSet) {
  Random random(31);
  const double sigma[] = {0.3, 0.05, 0.1};
  ParticleSet particles;
  particles.resize(20000);
  particles.log_weight.setConstant(-std::log(20000.0));
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    const double x = sigma[0] * random.gaussian();
    const double y = sigma[1] * random.gaussian();
    particles.setPose(i, {-3.0 + x, 2.0 + y, wrapAngle(kPi + sigma[2] * random.gaussian())});
  }
  const PoseEstimate estimate = weightedMean(particles);
  EXPECT_NEAR(estimate.base_in_map.x, -3.0, 0.01);
  EXPECT_NEAR(estimate.base_in_map.y, 2.0, 0.002);
  EXPECT_NEAR(wrapAngle(estimate.base_in_map.yaw - kPi), 0.0, 0.004);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(estimate.covariance(i, i)), sigma[i], 0.03 * sigma[i]);
  }
}

TEST(WeightedMean, IsPreciseFarFromTheMapsOrigin) {
  const PoseEstimate estimate =
      weightedMean(setOf({{{1e6 + 0.01, -1e6, 0.0}, 0.5}, {{1e6 - 0.01, -1e6, 0.0}, 0.5}}));
  EXPECT_NEAR(estimate.base_in_map.x, 1e6, 1e-9);
  EXPECT_NEAR(estimate.covariance(0, 0), 1e-4, 1e-9);
}

TEST(WeightedMean, OfOneParticleIsThatParticle) {
  const PoseEstimate estimate = weightedMean(setOf({{{1.0, 2.0, 3.0}, 1.0}}));
  EXPECT_EQ(estimate.base_in_map.x, 1.0);
  EXPECT_EQ(estimate.base_in_map.y, 2.0);
  EXPECT_EQ(estimate.base_in_map.yaw, 3.0);
  EXPECT_TRUE(estimate.covariance.isZero(0.0));
}

TEST(BestParticle, IsTheHeaviestWithTheSetsCovarianceAboutIt) {
  const PoseEstimate estimate =
      bestParticle(setOf({{{1.0, 0.0, 0.0}, 0.3}, {{2.0, 0.0, 0.0}, 0.4}, {{5.0, 0.0, 0.0}, 0.3}}));
  EXPECT_EQ(estimate.base_in_map.x, 2.0);
  EXPECT_NEAR(estimate.covariance(0, 0), 0.3 * 1.0 + 0.3 * 9.0, 1e-12);
}

TEST(Propagate, ComposesThePose) {
  const PoseEstimate later =
      propagate({{1.0, 2.0, kPi / 2}, {}}, {0.5, 0.1, 0.2}, Eigen::Matrix3d::Zero());
  EXPECT_NEAR(later.base_in_map.x, 0.9, 1e-12);
  EXPECT_NEAR(later.base_in_map.y, 2.5, 1e-12);
  EXPECT_NEAR(later.base_in_map.yaw, kPi / 2 + 0.2, 1e-12);
}

TEST(Propagate, AgreesWithTheCovarianceOfAMovedSet) {
  Random random(37);
  const Pose2 start{1.0, 2.0, 0.8};
  const Pose2 delta{0.6, -0.1, 0.3};
  const Eigen::Vector3d start_sigma(0.05, 0.02, 0.03);
  const Eigen::Vector3d noise_sigma(0.04, 0.01, 0.02);
  PoseEstimate estimate{start, Eigen::Matrix3d(start_sigma.array().square().matrix().asDiagonal())};
  const PoseEstimate later =
      propagate(estimate, delta, noise_sigma.array().square().matrix().asDiagonal());

  ParticleSet particles;
  particles.resize(40000);
  particles.log_weight.setConstant(-std::log(40000.0));
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    double z[6];
    for (double& value : z) value = random.gaussian();
    const Pose2 from{start.x + start_sigma[0] * z[0], start.y + start_sigma[1] * z[1],
                     start.yaw + start_sigma[2] * z[2]};
    const Pose2 step{delta.x + noise_sigma[0] * z[3], delta.y + noise_sigma[1] * z[4],
                     delta.yaw + noise_sigma[2] * z[5]};
    particles.setPose(i, compose(from, step));
  }
  const Eigen::Matrix3d sampled = weightedMean(particles).covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double scale = std::sqrt(sampled(i, i) * sampled(j, j));
      EXPECT_NEAR(later.covariance(i, j), sampled(i, j), 0.04 * scale) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace racecar_mcl
