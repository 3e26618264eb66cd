#include "racecar_mcl/filter/convergence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "racecar_mcl/filter/resampling.h"

namespace racecar_mcl {
namespace {

Motion driven(double metres, double radians = 0.0) {
  Motion motion;
  motion.distance = metres;
  motion.rotation = radians;
  return motion;
}

/// `counts[i]` particles around place i, with a standard deviation of `spread` m; places are 10 m
/// apart.
ParticleSet placesOf(const std::vector<int>& counts, double spread = 0.05) {
  Random random(1);
  ParticleSet particles;
  Eigen::Index size = 0;
  for (const int count : counts) size += count;
  particles.resize(size);
  Eigen::Index next = 0;
  for (std::size_t place = 0; place < counts.size(); ++place) {
    for (int i = 0; i < counts[place]; ++i) {
      particles.setPose(next++, {10.0 * static_cast<double>(place) + spread * random.gaussian(),
                                 spread * random.gaussian(), spread * random.gaussian()});
    }
  }
  particles.log_weight.setConstant(-std::log(static_cast<double>(size)));
  return particles;
}

TEST(DecorrelationAfter, GrowsWithTheDistanceUpToOne) {
  EXPECT_NEAR(decorrelationAfter(driven(0.1), 0.5), 0.2, 1e-12);
  EXPECT_NEAR(decorrelationAfter(driven(0.1, 0.2), 0.5), 0.4, 1e-12);
  EXPECT_EQ(decorrelationAfter(driven(0.5), 0.5), 1.0);
  EXPECT_EQ(decorrelationAfter(driven(20.0), 0.5), 1.0);
}

TEST(DecorrelationAfter, IsOneWithoutADecorrelationDistance) {
  EXPECT_EQ(decorrelationAfter(driven(0.0), 0.0), 1.0);
  EXPECT_EQ(decorrelationAfter(driven(0.1), 0.0), 1.0);
}

TEST(DecorrelationAfter, IsSmallButAboveZeroWhileStationary) {
  EXPECT_GT(decorrelationAfter(driven(0.0), 0.5), 0.0);
  EXPECT_LT(decorrelationAfter(driven(0.0), 0.5), 0.1);
}

TEST(SingleCluster, IsTheClusterWithNearlyAllWeight) {
  const std::optional<Pose2> place = singleCluster(findClusters(placesOf({1, 19999})));
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->x, 10.0, 0.02);
}

TEST(SingleCluster, IsNoneForTwoClusters) {
  EXPECT_FALSE(singleCluster(findClusters(placesOf({5, 995}))).has_value());
  EXPECT_FALSE(singleCluster({}).has_value());
}

TEST(SingleCluster, IsNoneForAWideCluster) {
  EXPECT_FALSE(singleCluster(findClusters(placesOf({20000}, 1.0))).has_value());
}

TEST(KeepNear, RemovesTheWeightOfOtherPlaces) {
  ParticleSet particles = placesOf({500, 500});
  particles.yaw[999] += 2.0;
  keepNear({10.0, 0.0, 0.0}, &particles);
  EXPECT_NEAR(particles.log_weight.segment(500, 499).exp().sum(), 1.0, 1e-9);
  EXPECT_TRUE((particles.log_weight.head(500).exp() == 0.0).all());
  EXPECT_EQ(std::exp(particles.log_weight[999]), 0.0);
}

}  // namespace
}  // namespace racecar_mcl
