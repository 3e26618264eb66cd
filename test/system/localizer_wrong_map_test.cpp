// Localization on incomplete or wrong maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "offline/simulated_drive.h"
#include "sim/map_faults.h"

namespace racecar_mcl {
namespace {

/// Statistics of a drive after its first 0.5 s.
struct Drive {
  double worst_error = 0.0;                ///< m
  double longest_carried = 0.0;            ///< m, without a map
  std::map<LocalizationState, int> scans;  ///< by the verdict on them
  bool localized_after_carrying = false;
  std::uint64_t recoveries = 0;
};

class LocalizerOnAWrongMap : public ::testing::Test {
 protected:
  /// Starts localized at a random pose and follows the walls.
  Drive drive(std::uint64_t seed, double seconds) const {
    Random random(seed);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive simulated(course_, parameters_, {}, pose, 3.0, seed);
    PoseEstimate start{pose, Eigen::Matrix3d::Zero()};
    start.covariance.diagonal() << 0.01, 0.01, 0.0025;
    simulated.localizer().initialize(start);
    simulated.drive(0.5, [](const Observation&) {});
    EXPECT_EQ(simulated.localizer().status().state, LocalizationState::kLocalized) << seed;
    Drive drive;
    simulated.drive(seconds - 0.5, [&](const Observation& seen) {
      const LocalizationStatus& status = seen.result.status;
      drive.worst_error = std::max(drive.worst_error, seen.error);
      drive.longest_carried = std::max(drive.longest_carried, status.carried);
      drive.localized_after_carrying |=
          drive.longest_carried > 5.0 && status.state == LocalizationState::kLocalized;
      ++drive.scans[status.state];
    });
    drive.recoveries = simulated.localizer().counters().recoveries;
    return drive;
  }

  void give(OccupancyGrid map) { course_.map = makeLocalizationMap(std::move(map), parameters_); }

  /// The correct map without a third of its free space.
  void giveWithoutAWing(std::uint64_t seed) {
    Random random(seed);
    give(sim::eraseWing(right_, 0.33, random));
  }

  LocalizerParameters parameters_;
  Course course_ = loadCourse(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml", parameters_);
  const OccupancyGrid right_ = course_.map->grid;
};

TEST_F(LocalizerOnAWrongMap, CarriesThePoseThroughAWingThatTheMapLacks) {
  giveWithoutAWing(6);
  Drive through = drive(6, 20.0);
  EXPECT_GT(through.longest_carried, 20.0);
  EXPECT_LT(through.worst_error, 0.5);
  EXPECT_EQ(through.recoveries, 0u);
  EXPECT_EQ(through.scans[LocalizationState::kLost], 0);
  EXPECT_EQ(through.scans[LocalizationState::kInitializing], 0);
  EXPECT_GT(through.scans[LocalizationState::kDegraded], 300);
  EXPECT_TRUE(through.localized_after_carrying);
}

TEST_F(LocalizerOnAWrongMap, LosesItselfThereByWheelsAlone) {
  giveWithoutAWing(12);
  const Drive by_scans = drive(12, 16.0);
  parameters_.lidar_odometry = false;
  const Drive by_wheels = drive(12, 16.0);
  EXPECT_LT(by_scans.worst_error, 0.5);
  EXPECT_GT(by_wheels.worst_error, 3.0 * by_scans.worst_error);
}

TEST_F(LocalizerOnAWrongMap, StaysRightWhereAThirdOfTheWallsIsMissing) {
  Random random(1);
  give(sim::eraseWalls(right_, 0.33, random));
  Drive past_gaps = drive(1, 15.0);
  EXPECT_GT(past_gaps.longest_carried, 5.0);
  EXPECT_LT(past_gaps.worst_error, 0.1);
  EXPECT_EQ(past_gaps.recoveries, 0u);
  EXPECT_EQ(past_gaps.scans[LocalizationState::kLost], 0);
  EXPECT_GT(past_gaps.scans[LocalizationState::kLocalized], 100);
}

TEST_F(LocalizerOnAWrongMap, IsAtHomeWhereEverythingUnknownIsBlack) {
  give(sim::fillUnknown(right_));
  Drive filled = drive(1, 12.0);
  EXPECT_LT(filled.worst_error, 0.1);
  EXPECT_EQ(filled.recoveries, 0u);
  EXPECT_EQ(filled.longest_carried, 0.0);
  EXPECT_EQ(filled.scans.size(), filled.scans.count(LocalizationState::kLocalized));
}

}  // namespace
}  // namespace racecar_mcl
