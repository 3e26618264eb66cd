#include "racecar_mcl/verdict.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {
namespace {

/// A judge that is told of forty scans a second from a car at 3 m/s.
class VerdictTest : public ::testing::Test {
 protected:
  VerdictTest() {
    evidence_.fit = {0.95, 100};
    evidence_.position_sigma = 0.02;
    evidence_.travelled = 0.075;
  }

  /// The state after so many seconds of the same evidence.
  VerdictState after(double seconds) {
    for (int i = 0; i < std::lround(40.0 * seconds); ++i) {
      evidence_.stamp += 0.025;
      judge_.judge(evidence_);
    }
    return judge_.verdict().state;
  }

  Evidence evidence_;
  Judge judge_{VerdictParameters{}};
};

TEST_F(VerdictTest, ConvergesUntilASinglePlaceIsLeft) {
  EXPECT_EQ(judge_.verdict().state, VerdictState::kConverging);
  evidence_.converging = true;
  EXPECT_EQ(after(2.0), VerdictState::kConverging);
  evidence_.converging = false;
  EXPECT_EQ(after(0.1), VerdictState::kLocalized);
}

TEST_F(VerdictTest, IsNotLocalizedUntilASecondSearchAgrees) {
  evidence_.unconfirmed = true;
  EXPECT_EQ(after(2.0), VerdictState::kConverging);
  evidence_.fit.explained = 0.3;
  EXPECT_EQ(after(2.0), VerdictState::kLost);
  evidence_.fit.explained = 0.95;
  evidence_.unconfirmed = false;
  EXPECT_EQ(after(2.0), VerdictState::kLocalized);
}

TEST_F(VerdictTest, IsNotLocalizedWhereAStartIsExplainedBadly) {
  evidence_.fit.explained = 0.65;
  EXPECT_EQ(after(5.0), VerdictState::kConverging);
}

TEST_F(VerdictTest, IsLostWithinASecondOfBeamsThatNothingExplains) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  evidence_.fit.explained = 0.3;
  EXPECT_EQ(after(0.5), VerdictState::kLost);
  EXPECT_GT(judge_.doubtfulFor(), 0.2);
  EXPECT_GT(judge_.doubtfulScans(), 10);
  evidence_.fit.explained = 0.95;
  EXPECT_EQ(after(1.5), VerdictState::kLocalized);
  EXPECT_EQ(judge_.doubtfulFor(), 0.0);
  EXPECT_EQ(judge_.doubtfulScans(), 0);
}

TEST_F(VerdictTest, CountsDoubtOnWhereTheClockJumpsBack) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  evidence_.fit.explained = 0.3;
  EXPECT_EQ(after(1.0), VerdictState::kLost);
  evidence_.stamp -= 100.0;
  EXPECT_EQ(after(0.5), VerdictState::kLost);
  EXPECT_NEAR(judge_.doubtfulFor(), 0.475, 1e-6);
}

TEST_F(VerdictTest, SaysThatScansAreUnusableWhereTheClockJumpsBack) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  judge_.judgeUnusable(evidence_.stamp);
  EXPECT_EQ(judge_.judgeUnusable(evidence_.stamp - 100.0).state, VerdictState::kLocalized);
  EXPECT_EQ(judge_.judgeUnusable(evidence_.stamp - 99.0).state, VerdictState::kDegraded);
}

TEST_F(VerdictTest, IsDegradedWhereAFewBeamsMoreThanUsualAreUnexplained) {
  EXPECT_EQ(after(10.0), VerdictState::kLocalized);
  evidence_.fit.explained = 0.8;
  EXPECT_EQ(after(0.5), VerdictState::kDegraded);
}

TEST_F(VerdictTest, LearnsHowMuchAMapExplains) {
  evidence_.fit.explained = 0.82;  // less than any map at first, but not too little
  EXPECT_EQ(after(20.0), VerdictState::kLocalized);
  EXPECT_NEAR(judge_.verdict().usually, 0.82, 0.02);
  evidence_.fit.explained = 0.72;
  EXPECT_NE(after(0.7), VerdictState::kLost);
}

TEST_F(VerdictTest, TakesALowShareForUsualWhereASearchWasInVain) {
  evidence_.fit.explained = 0.75;
  EXPECT_EQ(after(1.0), VerdictState::kConverging);
  judge_.acceptAsUsual();
  EXPECT_EQ(after(0.1), VerdictState::kLocalized);
}

TEST_F(VerdictTest, NeverTakesHalfTheBeamsForEnough) {
  EXPECT_EQ(after(1.0), VerdictState::kLocalized);
  evidence_.fit.explained = 0.4;
  after(1.0);
  judge_.acceptAsUsual();
  EXPECT_EQ(after(0.1), VerdictState::kLost);
}

TEST_F(VerdictTest, IsLostWhileItSearchesAgain) {
  after(1.0);
  evidence_.converging = true;
  EXPECT_EQ(after(0.1), VerdictState::kLost);
}

TEST_F(VerdictTest, IsDegradedWhereTheEstimateIsWide) {
  after(1.0);
  evidence_.position_sigma = 0.5;
  EXPECT_EQ(after(0.1), VerdictState::kDegraded);
}

TEST_F(VerdictTest, IsDegradedWhereHardlyABeamReturns) {
  after(1.0);
  evidence_.fit = {};
  EXPECT_EQ(after(0.1), VerdictState::kDegraded);
  EXPECT_EQ(judge_.doubtfulFor(), 0.0) << "nothing to search the map with";
}

TEST_F(VerdictTest, IsDegradedWhereScansCorrectTheOdometryAllTheTime) {
  after(1.0);
  evidence_.correction = {0.02, 0.0};  // of 0.075 m
  EXPECT_EQ(after(3.0), VerdictState::kDegraded);
  EXPECT_NEAR(judge_.verdict().disagreement, 0.25, 0.04);
  evidence_.correction = {0.002, 0.0};
  EXPECT_EQ(after(3.0), VerdictState::kLocalized);
}

TEST_F(VerdictTest, ForgetsInAnotherPlaceWhatScansCorrected) {
  after(1.0);
  evidence_.correction = {0.02, 0.0};
  EXPECT_EQ(after(3.0), VerdictState::kDegraded);
  evidence_.correction = {5.0, 0.0};  // the way there
  evidence_.moved = true;
  EXPECT_EQ(after(0.03), VerdictState::kLocalized);
}

TEST_F(VerdictTest, IsDegradedAfterHalfASecondWithoutAUsableScan) {
  after(1.0);
  const double last = evidence_.stamp;
  EXPECT_EQ(judge_.judgeUnusable(last + 0.1).state, VerdictState::kLocalized);
  EXPECT_EQ(judge_.judgeUnusable(last + 0.7).state, VerdictState::kDegraded);
  EXPECT_EQ(after(0.1), VerdictState::kLocalized);
}

TEST_F(VerdictTest, AStartForgetsWhatWasKnownOfThePose) {
  after(1.0);
  judge_.startAgain();
  EXPECT_EQ(judge_.verdict().state, VerdictState::kConverging);
  evidence_.converging = true;
  EXPECT_EQ(after(0.1), VerdictState::kConverging);
}

TEST_F(VerdictTest, SaysItsReasonWithoutCommas) {
  for (const double explained : {0.95, 0.8, 0.3}) {
    evidence_.fit.explained = explained;
    after(1.0);
    EXPECT_FALSE(judge_.verdict().reason.empty());
    EXPECT_EQ(judge_.verdict().reason.find(','), std::string::npos);
  }
}

TEST(VerdictParameters, OutOfRangeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, 1e9}) {
    for (double VerdictParameters::*value :
         {&VerdictParameters::verdict_time, &VerdictParameters::degraded_deviations,
          &VerdictParameters::lost_below, &VerdictParameters::localized_sigma,
          &VerdictParameters::odometry_disagreement}) {
      VerdictParameters p;
      p.*value = bad;
      EXPECT_THROW(validate(p), ParameterError);
    }
  }
  EXPECT_NO_THROW(validate(VerdictParameters{}));
}

}  // namespace
}  // namespace racecar_mcl
