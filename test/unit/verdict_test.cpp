#include "racecar_mcl/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {
namespace {

/// A judge that is told of forty scans a second from a car at 3 m/s.
class VerdictTest : public ::testing::Test {
 protected:
  VerdictTest() {
    explain(0.95);
    evidence_.fit.beams = 100;
    evidence_.position_sigma = 0.02;
    evidence_.travelled = 0.075;
  }

  /// The other beams end where the map is unknown, but for those that contradict it.
  void explain(double share, double contradicted = 0.0, double obstructed = 0.0) {
    evidence_.fit.explained = share;
    evidence_.fit.contradicted = contradicted;
    evidence_.fit.obstructed = obstructed;
    evidence_.fit.unmapped = 1.0 - share - contradicted - obstructed;
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
  explain(0.3, 0.7);
  EXPECT_EQ(after(2.0), VerdictState::kLost);
  explain(0.95);
  EXPECT_EQ(after(2.0), VerdictState::kConverging);
  evidence_.unconfirmed = false;
  EXPECT_EQ(after(2.0), VerdictState::kLocalized);
}

TEST_F(VerdictTest, IsNotLocalizedWhereAStartIsExplainedBadly) {
  explain(0.6);
  EXPECT_EQ(after(5.0), VerdictState::kConverging);
  EXPECT_FALSE(judge_.wasLocalized());
}

TEST_F(VerdictTest, IsNotLocalizedWhereAStartContradictsTheMap) {
  explain(0.68, 0.28);
  EXPECT_EQ(after(5.0), VerdictState::kConverging);
  EXPECT_FALSE(judge_.wasLocalized());
}

TEST_F(VerdictTest, KnowsWhetherItWasLocalizedSinceTheStart) {
  EXPECT_FALSE(judge_.wasLocalized());
  after(1.0);
  EXPECT_TRUE(judge_.wasLocalized());
  explain(0.3, 0.5);
  EXPECT_EQ(after(1.0), VerdictState::kLost);
  EXPECT_TRUE(judge_.wasLocalized());
  judge_.startAgain();
  EXPECT_FALSE(judge_.wasLocalized());
}

TEST_F(VerdictTest, IsLostWithinASecondOfBeamsThatPassThroughWalls) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  explain(0.3, 0.5);
  EXPECT_EQ(after(0.5), VerdictState::kLost);
  EXPECT_NEAR(judge_.verdict().conflict, 0.43, 0.03);
  explain(0.95);
  EXPECT_EQ(after(1.5), VerdictState::kLocalized);
  EXPECT_LT(judge_.verdict().conflict, 0.01);
}

TEST_F(VerdictTest, CountsABeamThatEndsBeforeAWallHalf) {
  after(20.0);  // until no conflict is usual
  explain(0.3, 0.0, 0.3);
  EXPECT_EQ(after(3.0), VerdictState::kDegraded);
  EXPECT_NEAR(judge_.verdict().conflict, 0.15, 0.01);
  explain(0.3, 0.0, 0.6);
  EXPECT_EQ(after(3.0), VerdictState::kLost);
  EXPECT_NEAR(judge_.verdict().conflict, 0.3, 0.01);
  explain(0.3, 0.3, 0.0);
  EXPECT_EQ(after(3.0), VerdictState::kLost);
  EXPECT_NEAR(judge_.verdict().conflict, 0.3, 0.01);
}

TEST_F(VerdictTest, IsDegradedNotLostWhereTheMapIsSilent) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  EXPECT_FALSE(judge_.mapIsSilent());
  EXPECT_EQ(judge_.verdict().carried, 0.0);
  explain(0.05);
  for (int second = 0; second < 20; ++second) {
    EXPECT_EQ(after(1.0), VerdictState::kDegraded) << second;
  }
  EXPECT_TRUE(judge_.mapIsSilent());
  EXPECT_EQ(judge_.verdict().conflict, 0.0);
  EXPECT_NEAR(judge_.verdict().carried, 60.0, 0.5);
  EXPECT_NEAR(judge_.usual(), 0.95, 0.01) << "it teaches nothing of the map";
  explain(0.95);
  EXPECT_EQ(after(1.5), VerdictState::kLocalized);
  EXPECT_FALSE(judge_.mapIsSilent());
  EXPECT_LT(judge_.verdict().carried, 5.0);
  EXPECT_GT(judge_.verdict().carried, 0.1) << "one good scan is no proof";
  after(3.0);
  EXPECT_NEAR(judge_.verdict().carried, 0.0, 0.01);
}

TEST_F(VerdictTest, IsNotLostWhereMostBeamsAreExplained) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  explain(0.55, 0.45);
  EXPECT_EQ(after(3.0), VerdictState::kDegraded);
  EXPECT_GT(judge_.verdict().conflict, 0.4);
}

TEST_F(VerdictTest, StaysLostWhereTheClockJumpsBack) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  explain(0.3, 0.5);
  EXPECT_EQ(after(1.0), VerdictState::kLost);
  evidence_.stamp -= 100.0;
  EXPECT_EQ(after(0.5), VerdictState::kLost);
}

TEST_F(VerdictTest, SaysThatScansAreUnusableWhereTheClockJumpsBack) {
  EXPECT_EQ(after(5.0), VerdictState::kLocalized);
  judge_.judgeUnusable(evidence_.stamp);
  EXPECT_EQ(judge_.judgeUnusable(evidence_.stamp - 100.0).state, VerdictState::kLocalized);
  EXPECT_EQ(judge_.judgeUnusable(evidence_.stamp - 99.0).state, VerdictState::kDegraded);
}

TEST_F(VerdictTest, IsDegradedWhereAFewBeamsMoreThanUsualAreUnexplained) {
  EXPECT_EQ(after(10.0), VerdictState::kLocalized);
  explain(0.8);
  EXPECT_EQ(after(0.5), VerdictState::kDegraded);
}

TEST_F(VerdictTest, LearnsHowMuchAMapExplains) {
  explain(0.82);  // less than any map at first, but not too little
  EXPECT_EQ(after(20.0), VerdictState::kLocalized);
  EXPECT_NEAR(judge_.verdict().usually, 0.82, 0.02);
  explain(0.72, 0.2);
  EXPECT_NE(after(0.7), VerdictState::kLost);
}

TEST_F(VerdictTest, LearnsALowShareOfScansThatDoNotContradictTheMap) {
  EXPECT_EQ(after(1.0), VerdictState::kLocalized);
  explain(0.72, 0.0, 0.2);
  EXPECT_EQ(after(0.5), VerdictState::kDegraded);
  EXPECT_EQ(after(20.0), VerdictState::kLocalized);
  EXPECT_NEAR(judge_.verdict().usually, 0.72, 0.01);
}

TEST_F(VerdictTest, LearnsNothingOfScansThatContradictTheMap) {
  EXPECT_EQ(after(1.0), VerdictState::kLocalized);
  explain(0.66, 0.34);
  after(1.5);  // until it is averaged
  const double usual = judge_.usual();
  EXPECT_EQ(after(20.0), VerdictState::kDegraded);
  EXPECT_EQ(judge_.usual(), usual);
}

TEST_F(VerdictTest, NeverTakesThreeFifthsOfTheBeamsForEnough) {
  EXPECT_EQ(after(1.0), VerdictState::kLocalized);
  explain(0.6);
  after(2.0);
  const double usual = judge_.usual();
  EXPECT_EQ(after(100.0), VerdictState::kDegraded);
  EXPECT_EQ(judge_.usual(), usual);
}

TEST_F(VerdictTest, LearnsHowMuchConflictIsUsualUpToALimit) {
  explain(0.72, 0.1);
  after(60.0);
  EXPECT_NEAR(judge_.verdict().conflict, 0.0, 0.01);
  explain(0.72, 0.28);
  after(100.0);
  EXPECT_NEAR(judge_.verdict().conflict, 0.03, 0.005);
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
  EXPECT_EQ(after(3.0), VerdictState::kDegraded);
  EXPECT_EQ(judge_.verdict().conflict, 0.0) << "nothing to search the map with";
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
  const auto expectReason = [this](VerdictState state) {
    EXPECT_EQ(after(1.0), state);
    EXPECT_FALSE(judge_.verdict().reason.empty());
    EXPECT_EQ(judge_.verdict().reason.find(','), std::string::npos);
  };
  explain(0.5);
  expectReason(VerdictState::kConverging);
  explain(0.95);
  expectReason(VerdictState::kLocalized);
  explain(0.4);
  expectReason(VerdictState::kDegraded);
  explain(0.3, 0.7);
  expectReason(VerdictState::kLost);
}

TEST(VerdictParameters, OutOfRangeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, 1e9}) {
    for (double VerdictParameters::*value :
         {&VerdictParameters::verdict_time, &VerdictParameters::degraded_deviations,
          &VerdictParameters::lost_conflict, &VerdictParameters::localized_sigma,
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
