#include "racecar_mcl/obstacles/obstacle_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.025;  // s

using Clusters = std::vector<ObstacleCluster>;
using Tracks = std::vector<ObstacleTrack>;

class ObstacleTrackerTest : public ::testing::Test {
 protected:
  ObstacleCluster clusterAt(double x, double y) {
    const Eigen::Vector2d noise(random_.gaussian(), random_.gaussian());
    ObstacleCluster cluster;
    cluster.position_in_map = Eigen::Vector2d(x, y) + 0.01 * noise;
    cluster.covariance = 1e-4 * Eigen::Matrix2d::Identity();
    cluster.extent = 0.3;
    cluster.returns = 10;
    return cluster;
  }

  /// Scans at 40 Hz; `clusters(t)` are those `t` seconds after the start.
  template <typename ClustersAt>
  Tracks track(double seconds, const ClustersAt& clusters) {
    Tracks tracks;
    for (double t = 0.0; t < seconds; t += kPeriod) {
      tracks = tracker_.update(clusters(t), 100.0 + t);
    }
    return tracks;
  }

  Random random_{1};
  ObstacleTracker tracker_;
};

TEST_F(ObstacleTrackerTest, EstimatesAConstantVelocity) {
  const Tracks tracks =
      track(0.5, [&](double t) { return Clusters{clusterAt(1.0 + 2.0 * t, 3.0 - 1.0 * t)}; });
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_NEAR(tracks[0].velocity_in_map.x(), 2.0, 0.2);
  EXPECT_NEAR(tracks[0].velocity_in_map.y(), -1.0, 0.2);
  EXPECT_NEAR(tracks[0].position_in_map.x(), 1.95, 0.03);
  EXPECT_DOUBLE_EQ(tracks[0].extent, 0.3);
  EXPECT_DOUBLE_EQ(tracks[0].first_stamp, 100.0);
}

TEST_F(ObstacleTrackerTest, ConfirmsAfterFiveScans) {
  for (int scan = 1; scan <= 6; ++scan) {
    const Tracks tracks = tracker_.update({clusterAt(1.0, 1.0)}, 100.0 + kPeriod * scan);
    EXPECT_EQ(tracks.size(), scan < 5 ? 0u : 1u) << scan;
  }
}

TEST_F(ObstacleTrackerTest, KeepsIdsWhileTwoObstaclesPassEachOther) {
  const auto upperId = [](const Tracks& tracks) {
    for (const ObstacleTrack& track : tracks) {
      if (track.position_in_map.y() > 0.2) return track.id;
    }
    return 0;
  };
  int before = 0;
  const Tracks after = track(2.0, [&](double t) {
    if (t > 0.5 && before == 0) before = upperId(tracker_.update({}, 100.0 + t));
    Clusters clusters{clusterAt(2.0 * t, 0.4), clusterAt(4.0 - 2.0 * t, 0.0)};
    if (t > 1.0) std::swap(clusters[0], clusters[1]);
    return clusters;
  });
  ASSERT_EQ(after.size(), 2u);
  EXPECT_GT(before, 0);
  EXPECT_EQ(upperId(after), before);
  for (const ObstacleTrack& track : after) {
    EXPECT_LE(track.id, 2);
    EXPECT_NEAR(track.velocity_in_map.x(), track.id == before ? 2.0 : -2.0, 0.3);
  }
}

TEST_F(ObstacleTrackerTest, PredictsAnOccludedObstacle) {
  const Tracks tracks = track(1.0, [&](double t) {
    return t > 0.5 && t < 0.8 ? Clusters{} : Clusters{clusterAt(2.0 * t, 0.0)};
  });
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].id, 1);
  const Tracks hidden = tracker_.update({}, 101.1);
  ASSERT_EQ(hidden.size(), 1u);
  EXPECT_NEAR(hidden[0].position_in_map.x(), 2.2, 0.1);
  EXPECT_LT(hidden[0].last_stamp, 101.0);
}

TEST_F(ObstacleTrackerTest, DeletesTracksThatAreNotSeenForHalfASecond) {
  track(0.5, [&](double) { return Clusters{clusterAt(1.0, 1.0)}; });
  EXPECT_EQ(tracker_.update({}, 100.9).size(), 1u);
  EXPECT_TRUE(tracker_.update({}, 101.0).empty());
}

TEST_F(ObstacleTrackerTest, StartsANewTrackAfterALongGap) {
  const Tracks before = track(0.5, [&](double) { return Clusters{clusterAt(1.0, 1.0)}; });
  ASSERT_EQ(before.size(), 1u);
  Tracks after;
  for (int scan = 0; scan < 5; ++scan) {
    after = tracker_.update({clusterAt(1.0, 1.0)}, 200.0 + kPeriod * scan);
  }
  ASSERT_EQ(after.size(), 1u);
  EXPECT_NE(after[0].id, before[0].id);
}

TEST_F(ObstacleTrackerTest, StartsAgainIfTheClockIsSetBack) {
  track(0.5, [&](double) { return Clusters{clusterAt(1.0, 1.0)}; });
  EXPECT_TRUE(tracker_.update({clusterAt(1.0, 1.0)}, 50.0).empty());
  EXPECT_TRUE(tracker_.update({clusterAt(1.0, 1.0)}, 50.0 + kPeriod).empty());
}

TEST_F(ObstacleTrackerTest, DoesNotAssociateAcrossTheGate) {
  const Tracks tracks =
      track(0.5, [&](double t) { return Clusters{clusterAt(t < 0.25 ? 0.0 : 1.5, 0.0)}; });
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_NEAR(tracks[0].position_in_map.x(), 0.0, 0.1);
  EXPECT_NEAR(tracks[1].position_in_map.x(), 1.5, 0.1);
  EXPECT_NEAR(tracks[1].velocity_in_map.x(), 0.0, 0.3);
}

TEST_F(ObstacleTrackerTest, ConfirmsAfterTheScansOfTheParameter) {
  ObstacleTrackerParameters parameters;
  parameters.confirmation_scans = 2;
  tracker_ = ObstacleTracker(parameters);
  EXPECT_EQ(tracker_.update({clusterAt(1.0, 1.0)}, 100.0).size(), 0u);
  EXPECT_EQ(tracker_.update({clusterAt(1.0, 1.0)}, 100.0 + kPeriod).size(), 1u);
}

TEST_F(ObstacleTrackerTest, DeletesATrackAfterTheTimeoutOfTheParameter) {
  for (const double timeout : {0.1, 0.9}) {
    ObstacleTrackerParameters parameters;
    parameters.timeout = timeout;
    tracker_ = ObstacleTracker(parameters);
    const auto seen = [&](double) { return Clusters{clusterAt(1.0, 1.0)}; };
    const Tracks tracks = track(0.5, seen);
    ASSERT_EQ(tracks.size(), 1u);
    const double last = tracks[0].last_stamp;
    EXPECT_EQ(tracker_.update({}, last + timeout - 0.01).size(), 1u) << timeout;
    EXPECT_EQ(tracker_.update({}, last + timeout + 0.01).size(), 0u) << timeout;
  }
}

TEST_F(ObstacleTrackerTest, TakesADistantClusterForTheObstacleWithinTheGate) {
  const auto idAfterAStep = [&](double gate) {
    ObstacleTrackerParameters parameters;
    parameters.gate = gate;
    tracker_ = ObstacleTracker(parameters);
    const Tracks tracks =
        track(1.5, [&](double t) { return Clusters{clusterAt(t < 0.5 ? 1.0 : 2.0, 1.0)}; });
    return tracks.back().id;
  };
  EXPECT_EQ(idAfterAStep(3.5), 2);
  EXPECT_EQ(idAfterAStep(1000.0), 1);
}

TEST_F(ObstacleTrackerTest, FollowsAChangeOfTheVelocityByTheAccelerationNoise) {
  const auto speedAfterAStop = [&](double noise) {
    ObstacleTrackerParameters parameters;
    parameters.acceleration_noise = noise;
    tracker_ = ObstacleTracker(parameters);
    const Tracks tracks =
        track(1.2, [&](double t) { return Clusters{clusterAt(0.5 * std::min(t, 1.0), 1.0)}; });
    return tracks.at(0).velocity_in_map.x();
  };
  EXPECT_LT(speedAfterAStop(4.0), 0.25);
  EXPECT_GT(speedAfterAStop(0.001), 0.35);
}

TEST_F(ObstacleTrackerTest, AllowsForTheUncertaintyOfThePose) {
  const auto idOfADistantCluster = [&](double sigma) {
    tracker_ = ObstacleTracker();
    const Tracks before = track(0.5, [&](double) { return Clusters{clusterAt(1.0, 1.0)}; });
    ObstacleCluster distant = clusterAt(1.6, 1.0);
    distant.covariance = sigma * sigma * Eigen::Matrix2d::Identity();
    Tracks tracks;
    for (int scan = 0; scan < 5; ++scan) {
      tracks = tracker_.update({distant}, 100.5 + kPeriod * scan);
    }
    return tracks.back().id - before.front().id;
  };
  EXPECT_NE(idOfADistantCluster(0.01), 0) << "another obstacle";
  EXPECT_EQ(idOfADistantCluster(0.3), 0) << "the same, from another pose";
}

}  // namespace
}  // namespace racecar_mcl
