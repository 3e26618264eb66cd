#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, WaitsForAMapThenForAStart) {
  Localizer localizer(fewBeams(), 1);
  EXPECT_FALSE(localizer.newestStamp());
  localizer.addOdometry(odometryAt(start_));
  EXPECT_EQ(localizer.update(scanAt(start_)).outcome, ScanOutcome::kNoMap);
  EXPECT_FALSE(localizer.hasMap());
  EXPECT_FALSE(localizer.initializeGlobally());
  EXPECT_FALSE(localizer.initialized());
  localizer.setMap(map());
  EXPECT_TRUE(localizer.hasMap());
  EXPECT_EQ(localizer.update(scanAt(start_)).outcome, ScanOutcome::kNoStart);
  EXPECT_FALSE(localizer.estimateAt(start_));
  localizer.initialize(startAt(start_pose_));
  EXPECT_EQ(localizer.update(scanAt(start_)).outcome, ScanOutcome::kUsed);
  EXPECT_EQ(localizer.counters().scans_seen, 3u);
  EXPECT_EQ(localizer.counters().scans_dropped, 2u);
  EXPECT_EQ(localizer.counters().scans_used, 1u);
}

TEST_F(LocalizerTest, AStartMayComeBeforeTheMap) {
  Localizer localizer(fewBeams(), 1);
  localizer.initialize(startAt(start_pose_));
  EXPECT_EQ(localizer.update(scanAt(start_)).outcome, ScanOutcome::kNoMap);
  localizer.setMap(map());
  EXPECT_EQ(localizer.update(scanAt(start_)).outcome, ScanOutcome::kUsed);
}

TEST_F(LocalizerTest, AStartWithAStampIsMovedToTheNewestByOdometry) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 3.0);
  localizer.initialize(startAt(truthAt(start_ + 2.0), 0.01), start_ + 2.0);
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.02, 0.02);
  const Pose2 now = truthAt(start_ + 3.0);
  for (const double no_odometry : {0.0, start_ - 5.0, start_ + 3.0, start_ + 100.0}) {
    localizer.initialize(startAt(now, 0.01), no_odometry);
    expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, now, 0.02, 0.02);
  }
}

TEST_F(LocalizerTest, AStartAppliesAtTheNewestStamp) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  // For a scan older than the start, the particles are moved back.
  localizer.addOdometry(odometryAt(start_ + 1.1));
  localizer.initialize(startAt(truthAt(start_ + 1.1), 0.05));
  expectNear(localizer.estimateAt(start_ + 1.1)->base_in_map, truthAt(start_ + 1.1), 0.02, 0.02);
  const ScanResult result = localizer.update(scanAt(start_ + 1.025));
  expectNear(result.update.estimate.base_in_map, truthAt(start_ + 1.025), 0.05, 0.04);
}

TEST_F(LocalizerTest, RejectsInvalidStartsWithoutAChange) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 0.5);
  const PoseEstimate before = *localizer.estimateAt(start_ + 0.5);
  EXPECT_THROW(localizer.initialize(startAt({-3.0, 1.0, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({3.0, 5.5, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({1e300, 0.0, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({kNan, 0.0, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({1.0, 1.0, kInf})), ParameterError);
  PoseEstimate wide = startAt({1.0, 1.0, 0.0});
  wide.covariance(0, 0) = kInf;
  EXPECT_THROW(localizer.initialize(wide), ParameterError);
  expectSame(*localizer.estimateAt(start_ + 0.5), before);
}

TEST_F(LocalizerTest, StartsAnywhereOnTheMap) {
  LocalizerParameters parameters = fewBeams();
  Localizer localizer = started(parameters);
  EXPECT_TRUE(localizer.initializeGlobally());
  EXPECT_EQ(localizer.particles().size(), parameters.filter.max_particles);
  EXPECT_TRUE((localizer.particles().x > 0.0 && localizer.particles().x < room_.width).all());
  EXPECT_TRUE((localizer.particles().y > 0.0 && localizer.particles().y < room_.height).all());
  EXPECT_GT(localizer.estimateAt(start_)->covariance(0, 0), 1.0);
}

TEST_F(LocalizerTest, AGlobalStartSearchesTheMapUnlessRelocalizationIsOff) {
  const auto error = [this](Relocalization relocalization) {
    LocalizerParameters parameters = fewBeams();
    parameters.filter.num_particles = parameters.filter.max_particles = 30;
    parameters.relocalization = relocalization;
    Localizer localizer = started(parameters);
    localizer.initializeGlobally();
    drive(&localizer, 0.0, kScanPeriod);
    const Pose2 found = localizer.estimateAt(start_ + kScanPeriod)->base_in_map;
    const Pose2 truth = truthAt(start_ + kScanPeriod);
    // The room looks the same from the other side.
    const Pose2 other{room_.width - truth.x, room_.height - truth.y, truth.yaw + kPi};
    return std::min(distance(found, truth), distance(found, other));
  };
  EXPECT_LT(error(Relocalization::kFull), 0.3);
  EXPECT_LT(error(Relocalization::kStart), 0.3);
  EXPECT_GT(error(Relocalization::kOff), 0.3);
}

TEST_F(LocalizerTest, AStartResetsTheStatus) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  ASSERT_EQ(localizer.status().state, LocalizationState::kLocalized);
  localizer.initialize(startAt(start_pose_));
  EXPECT_EQ(localizer.status().state, LocalizationState::kInitializing);
}

}  // namespace
}  // namespace racecar_mcl
