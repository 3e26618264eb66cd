#include "racecar_mcl/localizer/scan_clocks.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

class ScanClocksTest : public testing::Test {
 protected:
  /// Checks a stamp and records it if it is used.
  ScanOutcome take(double stamp, int lidar, const std::optional<double>& max_stamp = {}) {
    const ScanOutcome outcome = clocks_.check(stamp, lidar, max_stamp);
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

TEST_F(ScanClocksTest, ALidarWhoseClockIsSetDoesNotMoveTheTimeOfTheOthers) {
  for (const double offset : {-50.0, 50.0}) {
    clocks_.reset();
    EXPECT_EQ(take(100.0, 0, 100.1), ScanOutcome::kUsed);
    EXPECT_EQ(take(100.0, 1, 100.1), ScanOutcome::kUsed);
    for (int i = 1; i < 20; ++i) {
      const double now = 100.0 + 0.02 * i;
      EXPECT_EQ(take(now, 0, now + 0.1), ScanOutcome::kUsed) << i;
      EXPECT_NE(take(now + offset, 1, now + 0.1), ScanOutcome::kUsed) << i;
    }
    EXPECT_EQ(take(100.4, 1, 100.5), ScanOutcome::kUsed) << "its clock is right again";
  }
}

TEST_F(ScanClocksTest, AClockThatOdometryHasAsWellIsThatOfAllLidars) {
  EXPECT_EQ(take(100.0, 0, 100.1), ScanOutcome::kUsed);
  EXPECT_EQ(take(100.0, 1, 100.1), ScanOutcome::kUsed);
  EXPECT_EQ(take(10.0, 0, 10.1), ScanOutcome::kStampOutlier);
  EXPECT_EQ(take(10.02, 0, 10.1), ScanOutcome::kTimeJumpedBack);
  EXPECT_EQ(take(10.03, 1, 10.1), ScanOutcome::kUsed);
}

TEST_F(ScanClocksTest, GoesOnWithoutOdometry) {
  for (int i = 0; i < 400; ++i) {
    EXPECT_EQ(take(100.0 + 0.025 * i, 0, 100.1), ScanOutcome::kUsed) << i;
    EXPECT_EQ(take(100.01 + 0.025 * i, 1, 100.1), ScanOutcome::kUsed) << i;
  }
}

TEST_F(ScanClocksTest, ASilentLidarDoesNotHoldTheTimeOfTheOthers) {
  EXPECT_EQ(take(100.0, 1, 100.1), ScanOutcome::kUsed);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(take(100.0 + 0.02 * i, 0, 100.1 + 0.02 * i), ScanOutcome::kUsed);
  }
  EXPECT_EQ(take(50.0, 0, 102.1), ScanOutcome::kStampOutlier);
  EXPECT_EQ(take(50.02, 0, 102.1), ScanOutcome::kTimeJumpedBack);
  EXPECT_EQ(take(50.04, 0, 102.1), ScanOutcome::kUsed);
}

TEST_F(ScanClocksTest, AClockOfAllLidarsMayDifferFromThatOfOdometry) {
  EXPECT_EQ(take(100.0, 0, 100.1), ScanOutcome::kUsed);
  EXPECT_EQ(take(100.0, 1, 100.1), ScanOutcome::kUsed);
  int refused = 0;
  for (; take(50.0 + 0.02 * refused, refused % 2, 100.1 + 0.02 * refused) != ScanOutcome::kUsed;) {
    ASSERT_LT(++refused, 40);
  }
  EXPECT_GT(refused, 2);
}

TEST_F(ScanClocksTest, ALidarWithAWrongClockDoesNotRestartTheTimeOfTheOthers) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(take(100.0 + 0.02 * i, 0), ScanOutcome::kUsed);
    EXPECT_EQ(take(40.0 + 0.02 * i, 1), ScanOutcome::kOutOfOrder);
  }
}

}  // namespace
}  // namespace racecar_mcl
