#include "racecar_mcl/motion/clock_jump_detector.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.02;  // s

/// Stamps up to 0.5 s after the newest are plausible.
class Detector {
 public:
  StampCheck check(double stamp) {
    return detector_.check(stamp, detector_.newest().value_or(stamp) + 0.5);
  }
  ClockJumpDetector detector_{1.0};
};

/// Stamps every 0.02 s up to 10 s.
Detector running() {
  Detector detector;
  for (int i = 0; i <= 500; ++i) EXPECT_EQ(detector.check(i * kPeriod), StampCheck::kPlausible);
  return detector;
}

class OneWrongStamp : public testing::TestWithParam<double> {};

TEST_P(OneWrongStamp, IsAnOutlierAndTheNextIsPlausible) {
  Detector detector = running();
  EXPECT_EQ(detector.check(10.0 + GetParam()), StampCheck::kOutlier);
  EXPECT_EQ(detector.check(10.0 + kPeriod), StampCheck::kPlausible);
  EXPECT_EQ(detector.check(10.0 + GetParam()), StampCheck::kOutlier) << "again, but not in a row";
  EXPECT_EQ(detector.check(10.0 + 2 * kPeriod), StampCheck::kPlausible);
}

TEST_P(OneWrongStamp, RepeatedIsNoClock) {
  Detector detector = running();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(detector.check(10.0 + GetParam()), StampCheck::kOutlier);
  EXPECT_EQ(detector.check(10.0 + kPeriod), StampCheck::kPlausible);
}

TEST_P(OneWrongStamp, FollowedByAnotherIsAJump) {
  Detector detector = running();
  const double jump = GetParam();
  EXPECT_EQ(detector.check(10.0 + jump), StampCheck::kOutlier);
  EXPECT_EQ(detector.check(10.0 + jump + kPeriod), StampCheck::kClockJump);
  EXPECT_EQ(detector.check(10.0 + jump + 2 * kPeriod), StampCheck::kPlausible);
  EXPECT_EQ(detector.check(10.0 + 3 * kPeriod), StampCheck::kOutlier) << "the old time";
}

INSTANTIATE_TEST_SUITE_P(Sizes, OneWrongStamp, testing::Values(-1e9, -30.0, -1.2, 1.2, 30.0, 1e9));

TEST(ClockJumpDetector, SmallStepsBackAndAheadArePlausible) {
  Detector detector = running();
  EXPECT_EQ(detector.check(9.1), StampCheck::kPlausible);
  EXPECT_EQ(detector.check(10.5), StampCheck::kPlausible);
  EXPECT_EQ(detector.check(9.4), StampCheck::kOutlier) << "1.1 s before the newest";
}

TEST(ClockJumpDetector, EverySecondStampOfASlowSensorIsUsed) {
  Detector detector;
  EXPECT_EQ(detector.check(0.0), StampCheck::kPlausible);
  for (double stamp = 2.0; stamp < 20.0; stamp += 4.0) {
    EXPECT_EQ(detector.check(stamp), StampCheck::kOutlier);
    EXPECT_EQ(detector.check(stamp + 2.0), StampCheck::kClockJump);
  }
}

TEST(ClockJumpDetector, TheFirstStampMayBeFarToo) {
  ClockJumpDetector detector(1.0);
  EXPECT_EQ(detector.check(40.0, 10.0), StampCheck::kOutlier);
  EXPECT_EQ(detector.check(10.1, 10.3), StampCheck::kPlausible);
  detector.reset();
  EXPECT_EQ(detector.check(40.0, 10.0), StampCheck::kOutlier);
  EXPECT_EQ(detector.check(40.1, 10.0), StampCheck::kClockJump) << "a clock of its own";
  EXPECT_EQ(*detector.newest(), 40.1);
}

TEST(ClockJumpDetector, AfterAResetAnyStampIsPlausible) {
  Detector detector = running();
  detector.check(-50.0);
  detector.detector_.reset();
  EXPECT_EQ(detector.check(1e6), StampCheck::kPlausible);
}

TEST(ClockJumpDetector, RemembersTheLongestRecentInterval) {
  Detector detector;
  EXPECT_EQ(detector.detector_.period(), 0.0);
  for (const double stamp : {10.0, 10.02, 10.06, 10.08}) detector.check(stamp);
  EXPECT_NEAR(detector.detector_.period(), 0.036, 1e-9);
  for (int i = 1; i <= 20; ++i) detector.check(10.08 + i * kPeriod);
  EXPECT_NEAR(detector.detector_.period(), kPeriod, 1e-9);
  detector.check(-30.0);
  EXPECT_NEAR(detector.detector_.period(), kPeriod, 1e-9) << "not by an outlier";
}

}  // namespace
}  // namespace racecar_mcl
