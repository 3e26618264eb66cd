#include "racecar_mcl/localizer/obstacle_observer.h"

#include <gtest/gtest.h>

#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

constexpr int kAllBeams = 100000;

/// A fast car with a slow lidar: sweeps are distorted by 0.1 m and 0.1 rad.
class ObstacleObserverTest : public LocalizerTest {
 protected:
  ObstacleObserverTest() {
    twist_ = {2.0, 0.0, 2.0};
    sweep_.seconds = 0.05;
  }

  /// The scan with ten beams that end 0.8 m ahead.
  Scan withObstacle(Scan scan) const {
    scan.ranges.segment(scan.size() / 2 - 5, 10).setConstant(0.8f);
    return scan;
  }

  /// After a drive of 1 s, the obstacles in the next scan.
  DetectedObstacles observe(Localizer* localizer, bool has_obstacle,
                            const ObstacleDetectionParameters& parameters = {}) const {
    drive(localizer, 0.0, 1.0);
    for (int tick = 1; tick <= 4; ++tick) {
      localizer->addOdometry(odometryAt(start_ + 1.0 + kOdometryPeriod * tick));
    }
    const Scan clear = scanAt(start_ + 1.0 + kScanPeriod);
    const Scan scan = has_obstacle ? withObstacle(clear) : clear;
    const ScanResult result = localizer->update(scan);
    EXPECT_TRUE(hasEstimate(result.outcome));
    return ObstacleObserver(parameters).detect(*localizer, scan, result);
  }
};

TEST_F(ObstacleObserverTest, FindsAnObstacleAheadOfTheCar) {
  Localizer localizer = started();
  const DetectedObstacles found = observe(&localizer, true);
  ASSERT_EQ(found.clusters.size(), 1u);
  EXPECT_EQ(found.clusters[0].returns, 10);
  const Pose2 seen =
      between(truthAt(start_ + 1.0 + kScanPeriod + 0.025),
              {found.points_in_map.row(0).mean(), found.points_in_map.row(1).mean(), 0.0});
  const Pose2 expected = compose(sweep_.laser_in_base, {0.8, 0.0, 0.0});
  EXPECT_NEAR(seen.x, expected.x, 0.05);
  EXPECT_NEAR(seen.y, expected.y, 0.05);
}

TEST_F(ObstacleObserverTest, FindsNothingInAnEmptyRoom) {
  Localizer localizer = started();
  EXPECT_TRUE(observe(&localizer, false).clusters.empty());
}

TEST_F(ObstacleObserverTest, DeskewsAllBeams) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  const double stamp = start_ + 1.0;
  for (int tick = 1; tick <= 3; ++tick) {
    localizer.addOdometry(odometryAt(stamp + kOdometryPeriod * tick));
  }
  const auto farthestFromWalls = [&](const Scan& scan) {
    const Pose2 lidar = compose(truthAt(stamp), scan.laser_in_base);
    double farthest = 0.0;
    for (Eigen::Index k = 0; k < scan.size(); ++k) {
      const double range = static_cast<double>(scan.ranges[k]);
      const double angle = lidar.yaw + static_cast<double>(scan.bearings[k]);
      farthest = std::max(farthest, room_.distanceToWall(lidar.x + range * std::cos(angle),
                                                         lidar.y + range * std::sin(angle)));
    }
    return farthest;
  };
  const Scan scan = scanAt(stamp);
  EXPECT_GT(farthestFromWalls(scan), 0.1);
  EXPECT_LT(farthestFromWalls(localizer.correctedScan(scan, kAllBeams)), 0.02);
  EXPECT_EQ(localizer.correctedScan(scan, kAllBeams).size(), scan.size());
  EXPECT_EQ(localizer.correctedScan(scan, 10).size(), 10);
}

TEST_F(ObstacleObserverTest, UsesTheFieldOfViewOfTheLocalizer) {
  LocalizerParameters parameters = fewBeams();
  Localizer localizer = started(parameters);
  drive(&localizer, 0.0, 1.0);
  const Scan scan = scanAt(start_ + 1.0);
  EXPECT_EQ(localizer.correctedScan(scan, kAllBeams).size(), scan.size());
  parameters.scan.scan_field_of_view = 2.35;
  localizer.setParameters(parameters, localizer.map());
  EXPECT_NEAR(localizer.correctedScan(scan, kAllBeams).size(), scan.size() / 2, 2);
}

TEST_F(ObstacleObserverTest, FindsNothingUnlessLocalizedOrDegraded) {
  Localizer localizer = started();
  localizer.addOdometry(odometryAt(start_ + kScanPeriod + 0.1));
  const Scan scan = withObstacle(scanAt(start_ + kScanPeriod));
  ScanResult result = localizer.update(scan);
  ObstacleObserver observer({});
  for (const LocalizationState state :
       {LocalizationState::kLocalized, LocalizationState::kDegraded,
        LocalizationState::kInitializing, LocalizationState::kLost}) {
    result.status.state = state;
    const bool is_usable =
        state == LocalizationState::kLocalized || state == LocalizationState::kDegraded;
    EXPECT_EQ(observer.detect(localizer, scan, result).clusters.size(), is_usable ? 1u : 0u);
  }
}

}  // namespace
}  // namespace racecar_mcl
