#include "racecar_mcl/monitoring/localization_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

/// A monitor with forty scans per second from a car at 3 m/s.
class LocalizationMonitorTest : public ::testing::Test {
 protected:
  LocalizationMonitorTest() {
    setMatch(0.95);
    input_.match.beams = 100;
    setSigma(0.02);
    input_.travelled = 0.075;
  }

  /// m, of the position in every direction.
  void setSigma(double sigma) {
    input_.estimate.covariance(0, 0) = input_.estimate.covariance(1, 1) = sigma * sigma;
  }

  /// The remaining beams end in unknown cells.
  void setMatch(double inlier_ratio, double contradicted = 0.0, double obstructed = 0.0) {
    input_.match.inlier_ratio = inlier_ratio;
    input_.match.contradicted = contradicted;
    input_.match.obstructed = obstructed;
    input_.match.unmapped = 1.0 - inlier_ratio - contradicted - obstructed;
  }

  /// The state after a time (s) with the same evidence.
  LocalizationState after(double seconds) {
    for (int i = 0; i < std::lround(40.0 * seconds); ++i) {
      input_.stamp += 0.025;
      monitor_.update(input_);
    }
    return monitor_.status().state;
  }

  MonitorInput input_;
  LocalizationMonitor monitor_{LocalizationMonitorParameters{}};
};

TEST_F(LocalizationMonitorTest, IsInitializingUntilASingleClusterIsLeft) {
  EXPECT_EQ(monitor_.status().state, LocalizationState::kInitializing);
  input_.converged = false;
  EXPECT_EQ(after(2.0), LocalizationState::kInitializing);
  input_.converged = true;
  EXPECT_EQ(after(0.1), LocalizationState::kLocalized);
}

TEST_F(LocalizationMonitorTest, IsNotLocalizedUntilASecondSearchAgrees) {
  input_.unconfirmed = true;
  EXPECT_EQ(after(2.0), LocalizationState::kInitializing);
  setMatch(0.3, 0.7);
  EXPECT_EQ(after(2.0), LocalizationState::kLost);
  setMatch(0.95);
  EXPECT_EQ(after(2.0), LocalizationState::kInitializing);
  input_.unconfirmed = false;
  EXPECT_EQ(after(2.0), LocalizationState::kLocalized);
}

TEST_F(LocalizationMonitorTest, IsNotLocalizedAfterAStartWithFewInliers) {
  setMatch(0.6);
  EXPECT_EQ(after(5.0), LocalizationState::kInitializing);
  EXPECT_FALSE(monitor_.wasLocalized());
}

TEST_F(LocalizationMonitorTest, IsNotLocalizedAfterAStartThatContradictsTheMap) {
  setMatch(0.68, 0.28);
  EXPECT_EQ(after(5.0), LocalizationState::kInitializing);
  EXPECT_FALSE(monitor_.wasLocalized());
}

TEST_F(LocalizationMonitorTest, RecordsWhetherItWasLocalizedSinceTheStart) {
  EXPECT_FALSE(monitor_.wasLocalized());
  after(1.0);
  EXPECT_TRUE(monitor_.wasLocalized());
  setMatch(0.3, 0.5);
  EXPECT_EQ(after(1.0), LocalizationState::kLost);
  EXPECT_TRUE(monitor_.wasLocalized());
  monitor_.reset();
  EXPECT_FALSE(monitor_.wasLocalized());
}

TEST_F(LocalizationMonitorTest, IsLostWithinASecondOfBeamsThatPassThroughWalls) {
  EXPECT_EQ(after(5.0), LocalizationState::kLocalized);
  setMatch(0.3, 0.5);
  EXPECT_EQ(after(0.5), LocalizationState::kLost);
  EXPECT_NEAR(monitor_.status().conflict, 0.43, 0.03);
  setMatch(0.95);
  EXPECT_EQ(after(1.5), LocalizationState::kLocalized);
  EXPECT_LT(monitor_.status().conflict, 0.01);
}

TEST_F(LocalizationMonitorTest, AveragesInliersAndConflictOverTheParameter) {
  for (const double seconds : {0.1, 0.25, 2.0}) {
    LocalizationMonitorParameters parameters;
    parameters.inlier_averaging_time = seconds;
    monitor_ = LocalizationMonitor(parameters);
    setMatch(0.95);
    after(20.0 * seconds);
    setMatch(0.35);
    after(seconds);  // one time constant
    EXPECT_NEAR(monitor_.status().inlier_ratio, 0.35 + 0.6 * std::exp(-1.0), 0.02) << seconds;
  }
}

TEST_F(LocalizationMonitorTest, AveragesOverTheTimeBetweenScans) {
  after(1.0);
  setMatch(0.2);
  input_.stamp += 10.0;
  monitor_.update(input_);
  EXPECT_NEAR(monitor_.status().inlier_ratio, 0.2, 0.01);
}

TEST_F(LocalizationMonitorTest, IsLostAboveTheConflictOfTheParameter) {
  for (const double limit : {0.2, 0.6}) {
    LocalizationMonitorParameters parameters;
    parameters.lost_conflict = limit;
    monitor_ = LocalizationMonitor(parameters);
    setMatch(0.95);
    after(20.0);
    setMatch(0.25, limit + 0.1);
    EXPECT_EQ(after(3.0), LocalizationState::kLost) << limit;
    setMatch(0.25, limit - 0.1);
    EXPECT_EQ(after(3.0), LocalizationState::kDegraded) << limit;
  }
}

TEST_F(LocalizationMonitorTest, CountsShortBeamsHalf) {
  after(20.0);  // until the baseline conflict is zero
  setMatch(0.3, 0.0, 0.3);
  EXPECT_EQ(after(3.0), LocalizationState::kDegraded);
  EXPECT_NEAR(monitor_.status().conflict, 0.15, 0.01);
  setMatch(0.3, 0.0, 0.6);
  EXPECT_EQ(after(3.0), LocalizationState::kLost);
  EXPECT_NEAR(monitor_.status().conflict, 0.3, 0.01);
  setMatch(0.3, 0.3, 0.0);
  EXPECT_EQ(after(3.0), LocalizationState::kLost);
  EXPECT_NEAR(monitor_.status().conflict, 0.3, 0.01);
}

TEST_F(LocalizationMonitorTest, IsDegradedNotLostOnAnUninformativeMap) {
  EXPECT_EQ(after(5.0), LocalizationState::kLocalized);
  EXPECT_TRUE(monitor_.mapIsInformative());
  EXPECT_EQ(monitor_.status().carried, 0.0);
  setMatch(0.05);
  for (int second = 0; second < 20; ++second) {
    EXPECT_EQ(after(1.0), LocalizationState::kDegraded) << second;
  }
  EXPECT_FALSE(monitor_.mapIsInformative());
  EXPECT_EQ(monitor_.status().conflict, 0.0);
  EXPECT_NEAR(monitor_.status().carried, 60.0, 0.5);
  EXPECT_NEAR(monitor_.baseline(), 0.95, 0.01) << "the baseline is kept";
  setMatch(0.95);
  EXPECT_EQ(after(1.5), LocalizationState::kLocalized);
  EXPECT_TRUE(monitor_.mapIsInformative());
  EXPECT_LT(monitor_.status().carried, 5.0);
  EXPECT_GT(monitor_.status().carried, 0.1) << "it decays with the distance";
  after(3.0);
  EXPECT_NEAR(monitor_.status().carried, 0.0, 0.01);
}

TEST_F(LocalizationMonitorTest, IsNotLostWithManyInliers) {
  EXPECT_EQ(after(5.0), LocalizationState::kLocalized);
  setMatch(0.55, 0.45);
  EXPECT_EQ(after(3.0), LocalizationState::kDegraded);
  EXPECT_GT(monitor_.status().conflict, 0.4);
}

TEST_F(LocalizationMonitorTest, StaysLostAfterAClockJump) {
  EXPECT_EQ(after(5.0), LocalizationState::kLocalized);
  setMatch(0.3, 0.5);
  EXPECT_EQ(after(1.0), LocalizationState::kLost);
  input_.stamp -= 100.0;
  EXPECT_EQ(after(0.5), LocalizationState::kLost);
}

TEST_F(LocalizationMonitorTest, ReportsUnusableScansAfterAClockJump) {
  EXPECT_EQ(after(5.0), LocalizationState::kLocalized);
  monitor_.recordUnusableScan(input_.stamp);
  EXPECT_EQ(monitor_.recordUnusableScan(input_.stamp - 100.0).state, LocalizationState::kLocalized);
  EXPECT_EQ(monitor_.recordUnusableScan(input_.stamp - 99.0).state, LocalizationState::kDegraded);
}

TEST_F(LocalizationMonitorTest, IsDegradedBelowTheBaselineInlierRatio) {
  EXPECT_EQ(after(10.0), LocalizationState::kLocalized);
  setMatch(0.8);
  EXPECT_EQ(after(0.5), LocalizationState::kDegraded);
}

TEST_F(LocalizationMonitorTest, EstimatesTheBaselineInlierRatio) {
  setMatch(0.82);  // below the initial baseline, above the minimum
  EXPECT_EQ(after(20.0), LocalizationState::kLocalized);
  EXPECT_NEAR(monitor_.status().baseline_inlier_ratio, 0.82, 0.02);
  setMatch(0.72, 0.2);
  EXPECT_NE(after(0.7), LocalizationState::kLost);
}

TEST_F(LocalizationMonitorTest, LimitsTheDeviationFromTheBaseline) {
  for (int i = 0; i < 60; ++i) {
    setMatch(0.97);
    after(0.5);
    setMatch(0.77);
    after(0.5);
  }
  EXPECT_EQ(monitor_.status().state, LocalizationState::kLocalized);
  setMatch(0.68);
  EXPECT_EQ(after(0.7), LocalizationState::kDegraded);
}

TEST_F(LocalizationMonitorTest, EstimatesALowBaselineWithoutConflict) {
  EXPECT_EQ(after(1.0), LocalizationState::kLocalized);
  setMatch(0.72, 0.0, 0.2);
  EXPECT_EQ(after(0.5), LocalizationState::kDegraded);
  EXPECT_EQ(after(20.0), LocalizationState::kLocalized);
  EXPECT_NEAR(monitor_.status().baseline_inlier_ratio, 0.72, 0.01);
}

TEST_F(LocalizationMonitorTest, KeepsTheBaselineDuringConflict) {
  EXPECT_EQ(after(1.0), LocalizationState::kLocalized);
  setMatch(0.66, 0.34);
  after(1.5);  // until the average has converged
  const double baseline = monitor_.baseline();
  EXPECT_EQ(after(20.0), LocalizationState::kDegraded);
  EXPECT_EQ(monitor_.baseline(), baseline);
}

TEST_F(LocalizationMonitorTest, NeverLowersTheBaselineToThreeFifths) {
  EXPECT_EQ(after(1.0), LocalizationState::kLocalized);
  setMatch(0.6);
  after(2.0);
  const double baseline = monitor_.baseline();
  EXPECT_EQ(after(100.0), LocalizationState::kDegraded);
  EXPECT_EQ(monitor_.baseline(), baseline);
}

TEST_F(LocalizationMonitorTest, EstimatesTheBaselineConflictUpToALimit) {
  setMatch(0.72, 0.1);
  after(60.0);
  EXPECT_NEAR(monitor_.status().conflict, 0.0, 0.01);
  setMatch(0.72, 0.28);
  after(100.0);
  EXPECT_NEAR(monitor_.status().conflict, 0.03, 0.005);
}

TEST_F(LocalizationMonitorTest, IsLostWhileItSearchesAgain) {
  after(1.0);
  input_.converged = false;
  EXPECT_EQ(after(0.1), LocalizationState::kLost);
}

TEST_F(LocalizationMonitorTest, IsDegradedForAnUncertainEstimate) {
  after(1.0);
  setSigma(0.5);
  EXPECT_EQ(after(0.1), LocalizationState::kDegraded);
}

TEST_F(LocalizationMonitorTest, IsDegradedWithTooFewReturns) {
  after(1.0);
  input_.match = {};
  EXPECT_EQ(after(3.0), LocalizationState::kDegraded);
  EXPECT_EQ(monitor_.status().conflict, 0.0) << "no returns are no conflict";
}

TEST_F(LocalizationMonitorTest, IsDegradedIfScansAndOdometryDisagree) {
  after(1.0);
  input_.correction = {0.02, 0.0};  // of 0.075 m
  EXPECT_EQ(after(3.0), LocalizationState::kDegraded);
  EXPECT_NEAR(monitor_.status().disagreement, 0.25, 0.04);
  input_.correction = {0.002, 0.0};
  EXPECT_EQ(after(3.0), LocalizationState::kLocalized);
}

TEST_F(LocalizationMonitorTest, CorrectionsOfTheStartPoseAreNoDisagreement) {
  input_.correction = {0.1, 0.0};
  EXPECT_EQ(after(0.3), LocalizationState::kLocalized);  // 0.9 m
  input_.correction = {0.0, 0.0};
  EXPECT_EQ(after(1.0), LocalizationState::kLocalized);
  EXPECT_NEAR(monitor_.status().disagreement, 0.0, 0.01);
}

TEST_F(LocalizationMonitorTest, ResetsTheDisagreementAfterAJump) {
  after(1.0);
  input_.correction = {0.02, 0.0};
  EXPECT_EQ(after(3.0), LocalizationState::kDegraded);
  input_.correction = {5.0, 0.0};  // the jump
  input_.jumped = true;
  EXPECT_EQ(after(0.03), LocalizationState::kLocalized);
}

TEST_F(LocalizationMonitorTest, IsDegradedAfterHalfASecondWithoutAUsableScan) {
  after(1.0);
  const double last = input_.stamp;
  EXPECT_EQ(monitor_.recordUnusableScan(last + 0.1).state, LocalizationState::kLocalized);
  EXPECT_EQ(monitor_.recordUnusableScan(last + 0.7).state, LocalizationState::kDegraded);
  EXPECT_EQ(after(0.1), LocalizationState::kLocalized);
}

TEST_F(LocalizationMonitorTest, AStartDiscardsTheEvidence) {
  after(1.0);
  monitor_.reset();
  EXPECT_EQ(monitor_.status().state, LocalizationState::kInitializing);
  input_.converged = false;
  EXPECT_EQ(after(0.1), LocalizationState::kInitializing);
}

TEST_F(LocalizationMonitorTest, ReasonsHaveNoCommas) {
  const auto expectReason = [this](LocalizationState state) {
    EXPECT_EQ(after(1.0), state);
    EXPECT_FALSE(monitor_.status().reason.empty());
    EXPECT_EQ(monitor_.status().reason.find(','), std::string::npos);
  };
  setMatch(0.5);
  expectReason(LocalizationState::kInitializing);
  setMatch(0.95);
  expectReason(LocalizationState::kLocalized);
  setMatch(0.4);
  expectReason(LocalizationState::kDegraded);
  setMatch(0.3, 0.7);
  expectReason(LocalizationState::kLost);
}

TEST(LocalizationMonitorParameters, OutOfRangeIsRejected) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, 1e9}) {
    for (double LocalizationMonitorParameters::*value :
         {&LocalizationMonitorParameters::inlier_averaging_time,
          &LocalizationMonitorParameters::degraded_deviations,
          &LocalizationMonitorParameters::lost_conflict,
          &LocalizationMonitorParameters::localized_sigma,
          &LocalizationMonitorParameters::odometry_disagreement}) {
      LocalizationMonitorParameters p;
      p.*value = bad;
      EXPECT_THROW(validate(p), ParameterError);
    }
  }
  EXPECT_NO_THROW(validate(LocalizationMonitorParameters{}));
}

TEST_F(LocalizationMonitorTest, IsDegradedAboveTheSigmaOfTheParameter) {
  for (const double limit : {0.1, 0.6}) {
    LocalizationMonitorParameters parameters;
    parameters.localized_sigma = limit;
    monitor_ = LocalizationMonitor(parameters);
    setSigma(0.9 * limit);
    EXPECT_EQ(after(1.0), LocalizationState::kLocalized) << limit;
    setSigma(1.1 * limit);
    EXPECT_EQ(after(1.0), LocalizationState::kDegraded) << limit;
  }
}

TEST_F(LocalizationMonitorTest, IsDegradedAboveTheDisagreementOfTheParameter) {
  for (const double limit : {0.15, 0.5}) {
    LocalizationMonitorParameters parameters;
    parameters.odometry_disagreement = limit;
    monitor_ = LocalizationMonitor(parameters);
    input_.correction = {0.7 * limit * input_.travelled, 0.0};
    EXPECT_EQ(after(20.0), LocalizationState::kLocalized) << limit;
    input_.correction = {1.4 * limit * input_.travelled, 0.0};
    EXPECT_EQ(after(20.0), LocalizationState::kDegraded) << limit;
  }
}

TEST_F(LocalizationMonitorTest, IsDegradedBelowTheBaselineByTheDeviationsOfTheParameter) {
  const auto stateWith = [&](double deviations) {
    LocalizationMonitorParameters parameters;
    parameters.degraded_deviations = deviations;
    monitor_ = LocalizationMonitor(parameters);
    setMatch(0.95);
    after(20.0);
    setMatch(0.75);
    return after(0.5);
  };
  EXPECT_EQ(stateWith(3.0), LocalizationState::kDegraded);
  EXPECT_EQ(stateWith(10.0), LocalizationState::kLocalized);
}

}  // namespace
}  // namespace racecar_mcl
