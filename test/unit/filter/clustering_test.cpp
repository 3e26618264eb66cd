#include "racecar_mcl/filter/clustering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "racecar_mcl/filter/resampling.h"
#include "support/weighted_set.h"

namespace racecar_mcl {
namespace {

TEST(Clusters, ABimodalSetIsNotAveragedIntoTheWallBetween) {
  Random random(32);
  std::vector<Weighted> members;
  scatter({0.0, 0.0, 0.3}, 0.1, 100, 0.6, random, &members);
  scatter({8.0, 0.0, 0.3}, 0.1, 100, 0.4, random, &members);
  const ParticleSet particles = setOf(members);
  EXPECT_NEAR(estimatePose(particles, EstimateFrom::kMean).base_in_map.x, 3.2, 0.1);
  const PoseEstimate cluster = estimatePose(particles, EstimateFrom::kCluster);
  EXPECT_NEAR(cluster.base_in_map.x, 0.0, 0.05);
  EXPECT_NEAR(std::sqrt(cluster.covariance(0, 0)), 0.1, 0.02);

  const std::vector<Cluster> clusters = findClusters(particles);
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_NEAR(clusters[0].weight, 0.6, 1e-9);
  EXPECT_NEAR(clusters[1].weight, 0.4, 1e-9);
  EXPECT_EQ(clusters[0].particles, 100);
  EXPECT_NEAR(clusters[1].estimate.base_in_map.x, 8.0, 0.05);
}

TEST(Clusters, AreOrderedByWeightNotByNumber) {
  Random random(33);
  std::vector<Weighted> members;
  scatter({0.0, 0.0, 0.0}, 0.1, 300, 0.3, random, &members);
  scatter({8.0, 0.0, 0.0}, 0.1, 10, 0.7, random, &members);
  EXPECT_NEAR(estimatePose(setOf(members), EstimateFrom::kCluster).base_in_map.x, 8.0, 0.2);
}

TEST(Clusters, OppositeHeadingsAtOnePositionAreTwo) {
  Random random(34);
  std::vector<Weighted> members;
  scatter({1.0, 1.0, 0.4}, 0.05, 50, 0.5, random, &members);
  scatter({1.0, 1.0, 0.4 - kPi}, 0.05, 50, 0.5, random, &members);
  EXPECT_EQ(findClusters(setOf(members)).size(), 2u);
}

TEST(Clusters, AHeadingAboutPiIsOne) {
  Random random(35);
  std::vector<Weighted> members;
  scatter({1.0, 1.0, kPi}, 0.2, 200, 1.0, random, &members);
  const std::vector<Cluster> clusters = findClusters(setOf(members));
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_NEAR(wrapAngle(clusters[0].estimate.base_in_map.yaw - kPi), 0.0, 0.05);
  EXPECT_NEAR(clusters[0].weight, 1.0, 1e-9);
}

TEST(Clusters, TouchAcrossEdgesAndCorners) {
  const PoseBins bins{1.0, 0.35};
  EXPECT_EQ(findClusters(setOf({{{0.5, 0.5, 0.0}, 0.5}, {{1.5, 1.5, 0.0}, 0.5}}), bins).size(), 1u);
  EXPECT_EQ(findClusters(setOf({{{0.5, 0.5, 0.0}, 0.5}, {{-0.5, 0.5, 0.0}, 0.5}}), bins).size(),
            1u);
  EXPECT_EQ(findClusters(setOf({{{0.5, 0.5, 0.0}, 0.5}, {{2.5, 0.5, 0.0}, 0.5}}), bins).size(), 2u);
}

TEST(Clusters, OmitParticlesWithoutWeight) {
  const std::vector<Cluster> clusters =
      findClusters(setOf({{{0.0, 0.0, 0.0}, 0.0}, {{50.0, 0.0, 0.0}, 1.0}}));
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_EQ(clusters[0].estimate.base_in_map.x, 50.0);
}

TEST(Clusters, DoNotDependOnTheOrderOfTheParticles) {
  Random random(36);
  std::vector<Weighted> members;
  scatter({0.0, 0.0, 0.0}, 0.3, 60, 0.5, random, &members);
  scatter({5.0, 2.0, 1.0}, 0.3, 60, 0.3, random, &members);
  scatter({-4.0, 7.0, -2.0}, 0.3, 60, 0.2, random, &members);
  const std::vector<Cluster> forward = findClusters(setOf(members));
  const std::vector<Cluster> backward = findClusters(setOf({members.rbegin(), members.rend()}));
  ASSERT_EQ(forward.size(), backward.size());
  for (std::size_t i = 0; i < forward.size(); ++i) {
    EXPECT_NEAR(forward[i].weight, backward[i].weight, 1e-12);
    EXPECT_EQ(forward[i].particles, backward[i].particles);
  }
}

TEST(Clusters, HaveTheirOwnMeanAndCovariance) {
  const std::vector<Cluster> clusters = findClusters(setOf({{{9.0, 1.0, 0.3}, 0.1},
                                                            {{0.1, 0.0, 0.1}, 0.3},
                                                            {{9.2, 1.0, 0.3}, 0.3},
                                                            {{0.3, 0.0, 0.1}, 0.3}}));
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_NEAR(clusters[0].estimate.base_in_map.x, 0.2, 1e-12);
  EXPECT_NEAR(clusters[0].estimate.covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(clusters[1].estimate.base_in_map.x, 9.15, 1e-12);
  EXPECT_NEAR(clusters[1].estimate.covariance(0, 0), 0.0075, 1e-12);
}

TEST(Clusters, OfEqualWeightAreInTheOrderOfTheParticles) {
  const std::vector<Cluster> clusters = findClusters(
      setOf({{{5.0, 0.0, 0.0}, 0.25}, {{-5.0, 0.0, 0.0}, 0.25}, {{0.0, 0.0, 0.0}, 0.5}}));
  ASSERT_EQ(clusters.size(), 3u);
  EXPECT_EQ(clusters[0].estimate.base_in_map.x, 0.0);
  EXPECT_EQ(clusters[1].estimate.base_in_map.x, 5.0);
  EXPECT_EQ(clusters[2].estimate.base_in_map.x, -5.0);
}

TEST(Clusters, OfNothingAreNone) { EXPECT_TRUE(findClusters(ParticleSet{}).empty()); }

TEST(ClusterFinder, IsIndependentOfEarlierSets) {
  Random random(38);
  std::vector<Weighted> members;
  for (int place = 0; place < 30; ++place) {
    scatter({3.0 * place, 0.0, 0.2 * place}, 0.3, 20, 1.0 / 30.0, random, &members);
  }
  const ParticleSet many = setOf(members);
  const ParticleSet few = setOf({{{0.0, 0.0, 0.0}, 0.75}, {{9.0, 0.0, 0.0}, 0.25}});
  const ParticleSet one = setOf({{{1.0, 2.0, 3.0}, 1.0}});
  ClusterFinder finder;
  for (const ParticleSet* particles : {&many, &few, &one, &few, &many}) {
    const std::vector<Cluster> fresh = findClusters(*particles);
    const std::vector<Cluster>& again = finder.find(*particles, weightsOf(*particles));
    ASSERT_EQ(again.size(), fresh.size());
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      EXPECT_EQ(again[i].weight, fresh[i].weight);
      EXPECT_EQ(again[i].particles, fresh[i].particles);
      EXPECT_EQ(again[i].estimate.base_in_map.x, fresh[i].estimate.base_in_map.x);
    }
  }
}

}  // namespace
}  // namespace racecar_mcl
