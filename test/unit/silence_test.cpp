#include "racecar_mcl/silence.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

/// A watch that has just heard everything, at the time 100 s.
class SilenceTest : public ::testing::Test {
 protected:
  SilenceTest() {
    verdict_.state = VerdictState::kLocalized;
    verdict_.reason = "95 % of the beams are explained";
    hearAll(100.0);
  }

  void hearAll(double now) {
    watch_.hearScan(now);
    watch_.hearOdometry(now);
  }

  Verdict verdict_;
  SilenceWatch watch_{1.0};
};

TEST_F(SilenceTest, LeavesTheVerdictWhileScansAndOdometryCome) {
  for (double now = 100.0; now < 110.0; now += 0.9) {
    const Verdict verdict = watch_.judge(verdict_, now);
    EXPECT_EQ(verdict.state, VerdictState::kLocalized);
    EXPECT_EQ(verdict.reason, verdict_.reason);
    hearAll(now);
  }
}

TEST_F(SilenceTest, IsDegradedWhereOdometryGoesOnWithoutScans) {
  watch_.hearOdometry(101.5);
  const Verdict verdict = watch_.judge(verdict_, 101.5);
  EXPECT_EQ(verdict.state, VerdictState::kDegraded);
  EXPECT_EQ(verdict.reason, "no usable scan for 1.5 s");
  watch_.hearScan(101.6);
  EXPECT_EQ(watch_.judge(verdict_, 101.6).state, VerdictState::kLocalized);
}

TEST_F(SilenceTest, IsDegradedWhereScansGoOnWithoutOdometry) {
  watch_.hearScan(101.5);
  const Verdict verdict = watch_.judge(verdict_, 101.5);
  EXPECT_EQ(verdict.state, VerdictState::kDegraded);
  EXPECT_EQ(verdict.reason, "no usable odometry for 1.5 s");
}

TEST_F(SilenceTest, IsDegradedWhereNothingComes) {
  EXPECT_EQ(watch_.judge(verdict_, 103.0).reason, "no usable scan for 3.0 s");
}

TEST_F(SilenceTest, NeverMakesAVerdictBetter) {
  for (const VerdictState state :
       {VerdictState::kConverging, VerdictState::kDegraded, VerdictState::kLost}) {
    verdict_.state = state;
    EXPECT_EQ(watch_.judge(verdict_, 103.0).state, state);
    EXPECT_EQ(watch_.judge(verdict_, 103.0).reason, "no usable scan for 3.0 s");
  }
}

TEST_F(SilenceTest, CountsFromTheFirstLookWhereNothingWasEverHeard) {
  SilenceWatch watch(1.0);
  EXPECT_EQ(watch.judge(verdict_, 500.0).state, VerdictState::kLocalized);
  EXPECT_EQ(watch.judge(verdict_, 501.5).state, VerdictState::kDegraded);
}

TEST_F(SilenceTest, TakesNoSilenceFromAClockThatStandsStillOrIsSetBack) {
  EXPECT_EQ(watch_.judge(verdict_, 100.0).state, VerdictState::kLocalized);
  EXPECT_EQ(watch_.judge(verdict_, 20.0).state, VerdictState::kLocalized);
  EXPECT_EQ(watch_.judge(verdict_, 21.5).state, VerdictState::kDegraded) << "counted from 20 s";
}

TEST_F(SilenceTest, TakesNoSilenceFromAClockThatStarts) {
  hearAll(0.0);
  EXPECT_EQ(watch_.judge(verdict_, 0.0).state, VerdictState::kLocalized);
  EXPECT_EQ(watch_.judge(verdict_, 1000.0).state, VerdictState::kLocalized);
}

}  // namespace
}  // namespace racecar_mcl
