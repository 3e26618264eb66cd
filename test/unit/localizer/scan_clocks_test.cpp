#include "racecar_mcl/localizer/scan_clocks.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

class ScanClocksTest : public testing::Test {
 protected:
  /// Checks a stamp and records it if it is used.
  ScanOutcome take(double stamp, int lidar) {
    const ScanOutcome outcome = clocks_.check(stamp, lidar, {});
    if (outcome == ScanOutcome::kUsed) clocks_.recordUsed(stamp, lidar);
    return outcome;
  }

  ScanClocks clocks_{1.0};
};

TEST_F(ScanClocksTest, LidarsMayHaveTheSameStamp) {
  EXPECT_EQ(take(10.0, 0), ScanOutcome::kUsed);
  EXPECT_EQ(take(10.0, 1), ScanOutcome::kUsed);
  EXPECT_EQ(take(10.0, 1), ScanOutcome::kRepeatedStamp);
  EXPECT_EQ(take(10.0, 0), ScanOutcome::kRepeatedStamp);
}

TEST_F(ScanClocksTest, AScanThatArrivesAfterANewerOneOfAnotherLidarIsEvaluatedAtItsStamp) {
  EXPECT_EQ(take(10.0, 0), ScanOutcome::kUsed);
  EXPECT_EQ(clocks_.evaluationStamp(10.01), 10.01);
  EXPECT_EQ(clocks_.evaluationStamp(9.9), 10.0);
  EXPECT_EQ(take(9.9, 1), ScanOutcome::kUsed);
  EXPECT_EQ(*clocks_.newest(), 10.0);
  EXPECT_EQ(take(9.8, 1), ScanOutcome::kOutOfOrder) << "its own last scan is newer";
  EXPECT_EQ(take(9.6, 2), ScanOutcome::kOutOfOrder) << "0.4 s behind another lidar";
}

TEST_F(ScanClocksTest, TakesAnotherClockJump) {
  EXPECT_EQ(take(10.0, 0), ScanOutcome::kUsed);
  EXPECT_EQ(take(9.5, 0), ScanOutcome::kOutOfOrder);
  clocks_.setClockJump(0.4);
  EXPECT_EQ(take(9.5, 0), ScanOutcome::kStampOutlier);
  EXPECT_EQ(take(9.52, 0), ScanOutcome::kTimeJumpedBack);
}

TEST_F(ScanClocksTest, ASetBackClockIsThatOfAllLidars) {
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(take(100.0 + 0.02 * i, 0), ScanOutcome::kUsed);
    EXPECT_EQ(take(100.01 + 0.02 * i, 1), ScanOutcome::kUsed);
  }
  EXPECT_EQ(take(10.0, 0), ScanOutcome::kStampOutlier);
  EXPECT_EQ(take(10.01, 1), ScanOutcome::kStampOutlier);
  EXPECT_EQ(take(10.02, 0), ScanOutcome::kTimeJumpedBack);
  EXPECT_EQ(take(10.03, 1), ScanOutcome::kUsed);
  EXPECT_EQ(take(10.04, 0), ScanOutcome::kUsed);
}

TEST_F(ScanClocksTest, ALidarWithAWrongClockDoesNotRestartTheTimeOfTheOthers) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(take(100.0 + 0.02 * i, 0), ScanOutcome::kUsed);
    EXPECT_EQ(take(40.0 + 0.02 * i, 1), ScanOutcome::kOutOfOrder);
  }
}

}  // namespace
}  // namespace racecar_mcl
