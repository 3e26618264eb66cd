#include <gtest/gtest.h>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, StopsUpdatingWhileStationary) {
  twist_ = {};
  Localizer localizer = started();  // stationary_updates = 5
  int used = 0, stationary = 0;
  PoseEstimate last;
  drive(&localizer, 0.0, 1.0, [&](const ScanResult& result) {
    (result.outcome == ScanOutcome::kUsed ? used : stationary) += 1;
    if (result.outcome == ScanOutcome::kUsed) {
      EXPECT_EQ(stationary, 0);
      last = result.update.estimate;
    } else {
      EXPECT_EQ(result.outcome, ScanOutcome::kStationary);
      expectSame(result.update.estimate, last);
    }
  });
  EXPECT_EQ(used, 5);
  EXPECT_EQ(stationary, 35);
  expectSame(*localizer.estimateAt(start_ + 1.0), last);

  // It updates again on request, and all the time while driving.
  localizer.requestUpdate();
  EXPECT_EQ(localizer.update(scanAt(start_ + 1.01)).outcome, ScanOutcome::kUsed);
  drive(&localizer, 1.01, 1.5);
  start_pose_ = truthAt(start_ + 1.5);
  twist_ = {1.5, 0.0, 1.0};
  start_ += 1.5;
  drive(&localizer, 0.0, 1.0,
        [&](const ScanResult& result) { EXPECT_EQ(result.outcome, ScanOutcome::kUsed); });
}

TEST_F(LocalizerTest, TheCovarianceDoesNotGrowWhileStationary) {
  twist_ = {};
  LocalizerParameters parameters = fewBeams();
  parameters.stationary_updates = 1000;
  Localizer localizer = started(parameters);
  drive(&localizer, 0.0, 1.0);
  const double before = localizer.estimateAt(start_ + 1.0)->covariance.trace();
  drive(&localizer, 1.0, 10.0);
  EXPECT_LE(localizer.estimateAt(start_ + 10.0)->covariance.trace(), before);
}

TEST_F(LocalizerTest, UpdatesAgainIfAStationaryCarIsKidnapped) {
  twist_ = {};
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  ASSERT_EQ(localizer.status().state, LocalizationState::kLocalized);
  start_pose_ = {6.0, 3.5, 1.0};  // kidnapped: the wheels do not turn
  int used = 0;
  drive(&localizer, 1.0, 2.0,
        [&](const ScanResult& result) { used += result.outcome == ScanOutcome::kUsed ? 1 : 0; });
  EXPECT_GT(used, 20);
}

TEST_F(LocalizerTest, MissingOdometryDoesNotMeanStationary) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  // Both sensors paused; scans continue without odometry: none of them may be skipped.
  EXPECT_EQ(localizer.update(scanAt(start_ + 1.0 + 59 * kScanPeriod)).outcome,
            ScanOutcome::kStampOutlier);
  for (int i = 60; i < 200; ++i) {
    const double stamp = start_ + 1.0 + i * kScanPeriod;
    EXPECT_EQ(localizer.update(scanAt(stamp)).outcome, ScanOutcome::kUsed);
  }
}

}  // namespace
}  // namespace racecar_mcl
