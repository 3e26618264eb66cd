#include "racecar_mcl/localizer/pose_extrapolator.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/expect_pose.h"

namespace racecar_mcl {
namespace {

/// 2 m/s on a straight line, odometry every 0.02 s from 10 s on.
class PoseExtrapolatorTest : public testing::Test {
 protected:
  void odometryUpTo(double stamp) {
    for (; next_ < stamp + 1e-9; next_ += 0.02)
      extrapolator_.addOdometry({next_, {2.0, 0.0, 0.0}, {}});
  }

  static Scan scanAt(double stamp, float sweep_time = 0.02f) {
    Scan scan;
    scan.stamp = stamp;
    scan.bearings = scan.ranges = Eigen::ArrayXf::Ones(5);
    scan.seconds_after_stamp = Eigen::ArrayXf::LinSpaced(5, 0.0f, sweep_time);
    return scan;
  }

  static PoseEstimate at(double x) { return {{x, 0.0, 0.0}, 1e-4 * Eigen::Matrix3d::Identity()}; }

  PoseExtrapolator extrapolator_{{}, {}};
  double next_ = 10.0;
};

TEST_F(PoseExtrapolatorTest, HasNoPoseBeforeAStart) {
  odometryUpTo(11.0);
  EXPECT_FALSE(extrapolator_.initialized());
  EXPECT_FALSE(extrapolator_.estimateAt(11.0));
  EXPECT_FALSE(extrapolator_.lastEstimate());
  EXPECT_THROW(extrapolator_.beginScan(scanAt(11.0)), std::logic_error);
}

TEST_F(PoseExtrapolatorTest, PropagatesTheLastEstimateByOdometry) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(5.0), OdometryCalibration{});
  odometryUpTo(11.5);
  expectNear(extrapolator_.estimateAt(11.5)->base_in_map, {6.0, 0.0, 0.0}, 1e-9, 1e-9);
  expectNear(extrapolator_.estimateAt(11.25)->base_in_map, {5.5, 0.0, 0.0}, 1e-9, 1e-9);
  EXPECT_GT(extrapolator_.estimateAt(11.5)->covariance(0, 0), 1e-4);
}

TEST_F(PoseExtrapolatorTest, AScansMotionIsNotChangedByLaterOdometry) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  odometryUpTo(11.52);
  const PoseExtrapolator::ScanMotion motion = extrapolator_.beginScan(scanAt(11.5));
  EXPECT_NEAR(motion.motion.distance, 1.0, 1e-9);
  EXPECT_TRUE(motion.odometry_is_new);
  const MotionOrigin origin = motion.odometry.at(11.5);
  const Pose2 before = motion.odometry.motion(origin, 11.51).delta;
  odometryUpTo(13.0);
  expectNear(motion.odometry.motion(origin, 11.51).delta, before, 0.0, 0.0);
  expectNear(motion.odometry.motion(origin, 11.52).delta, {0.04, 0.0, 0.0}, 1e-9, 1e-9);
  expectNear(motion.odometry.motion(origin, 11.49).delta, {-0.02, 0.0, 0.0}, 1e-9, 1e-9);
}

TEST_F(PoseExtrapolatorTest, AnEstimateAppliesAtItsOwnTime) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  odometryUpTo(12.0);  // while the scan of 11.5 s is being used
  extrapolator_.setReference(at(1.1), 11.5, OdometryCalibration{}, 1.0, {});
  expectNear(extrapolator_.estimateAt(12.0)->base_in_map, {2.1, 0.0, 0.0}, 1e-9, 1e-9);
  EXPECT_EQ(extrapolator_.lastEstimate()->base_in_map.x, 1.1);
}

TEST_F(PoseExtrapolatorTest, TheCovarianceGrowsWithTheNoiseScale) {
  odometryUpTo(11.0);
  const auto varianceWith = [&](double noise_scale) {
    extrapolator_.setReference(at(0.0), 10.5, OdometryCalibration{}, noise_scale, {});
    return extrapolator_.estimateAt(11.0)->covariance(0, 0) - 1e-4;
  };
  EXPECT_NEAR(varianceWith(3.0), 9.0 * varianceWith(1.0), 1e-9);
}

TEST_F(PoseExtrapolatorTest, ThePoseContinuesAtTheSpeedOfTheCarWhereTheOdometryIsFrozen) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  Motion frozen;
  frozen.duration = 0.025;
  SlipCompensation slip;
  Motion right = frozen;
  right.delta.x = 3.0 * right.duration;
  for (int scan = 0; scan < 40; ++scan) slip.learn(right, right.delta);
  extrapolator_.setReference(at(0.0), 11.0, OdometryCalibration{}, 1.0, slip);
  EXPECT_NEAR(extrapolator_.estimateAt(11.05)->base_in_map.x, 0.1, 1e-9) << "odometry of 2 m/s";
  slip.learn(frozen, right.delta);
  extrapolator_.setReference(at(0.0), 11.0, OdometryCalibration{}, 1.0, slip);
  EXPECT_GT(extrapolator_.estimateAt(11.05)->base_in_map.x, 0.14);
  EXPECT_NEAR(extrapolator_.twist().vx, 3.0, 0.5);
  EXPECT_NEAR(extrapolator_.odometryOver(scanAt(11.0)).motion(MotionOrigin{11.0, {}}, 11.1).delta.x,
              0.3, 0.05);
  const PoseExtrapolator::ScanMotion scan = extrapolator_.beginScan(scanAt(11.05));
  EXPECT_GT(scan.motion.delta.x, 0.14);
  EXPECT_NEAR(scan.odometry.motion(scan.odometry.at(11.05), 11.06).delta.x,
              0.01 * scan.motion.compensation->vx, 1e-9);
}

TEST_F(PoseExtrapolatorTest, AScanWaitsForOdometryThatIsArriving) {
  EXPECT_FALSE(extrapolator_.covers(10.0)) << "no odometry yet";
  odometryUpTo(11.0);
  EXPECT_TRUE(extrapolator_.covers(10.99));
  EXPECT_FALSE(extrapolator_.covers(11.05));
  EXPECT_TRUE(extrapolator_.covers(11.6)) << "odometry has stopped";
}

TEST_F(PoseExtrapolatorTest, OnlyTheFirstScanWaitsIfThereIsNoOdometry) {
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  EXPECT_FALSE(extrapolator_.covers(11.0));
  extrapolator_.beginScan(scanAt(11.0));
  EXPECT_TRUE(extrapolator_.covers(11.1));
}

TEST_F(PoseExtrapolatorTest, ChecksTheOrderOfScans) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  EXPECT_EQ(extrapolator_.checkStamp(11.0), ScanOutcome::kUsed);
  extrapolator_.beginScan(scanAt(11.0));
  EXPECT_EQ(extrapolator_.checkStamp(11.0), ScanOutcome::kRepeatedStamp);
  EXPECT_EQ(extrapolator_.checkStamp(10.9), ScanOutcome::kOutOfOrder);
  EXPECT_EQ(extrapolator_.checkStamp(std::nan("")), ScanOutcome::kNotFinite);
  EXPECT_EQ(extrapolator_.checkStamp(1e308), ScanOutcome::kNotFinite);
  EXPECT_EQ(extrapolator_.checkStamp(2.975), ScanOutcome::kStampOutlier);
  EXPECT_EQ(extrapolator_.checkStamp(3.0), ScanOutcome::kTimeJumpedBack);
  EXPECT_EQ(extrapolator_.checkStamp(3.1), ScanOutcome::kUsed);
  EXPECT_EQ(extrapolator_.counters().time_jumps, 1u);
}

TEST_F(PoseExtrapolatorTest, OneScanWithAWrongStampIsDropped) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  EXPECT_EQ(extrapolator_.checkStamp(11.0), ScanOutcome::kUsed);
  extrapolator_.beginScan(scanAt(11.0));
  double stamp = 11.0;
  for (int i = 0; i < 10; ++i) extrapolator_.checkStamp(stamp += 0.025);
  for (const double wrong : {-30.0, -1.5, 0.1, 0.3, 1.5, 30.0, 1e9}) {
    EXPECT_EQ(extrapolator_.checkStamp(stamp + wrong), ScanOutcome::kStampOutlier) << wrong;
    EXPECT_EQ(*extrapolator_.newestStamp(), 11.0);
    EXPECT_EQ(extrapolator_.checkStamp(stamp += 0.025), ScanOutcome::kUsed);
  }
  EXPECT_EQ(extrapolator_.counters().time_jumps, 0u);
}

TEST_F(PoseExtrapolatorTest, ScansMayBeAheadOfOdometryThatIsLate) {
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  for (int i = 0; i < 40; ++i) {
    odometryUpTo(10.8 + 0.025 * i);
    EXPECT_EQ(extrapolator_.checkStamp(11.0 + 0.025 * i),
              i == 0 ? ScanOutcome::kStampOutlier : ScanOutcome::kUsed);
  }
}

TEST_F(PoseExtrapolatorTest, ScansMayPauseWhileOdometryContinues) {
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  EXPECT_EQ(extrapolator_.checkStamp(11.0), ScanOutcome::kUsed);
  odometryUpTo(14.0);
  EXPECT_EQ(extrapolator_.checkStamp(14.0), ScanOutcome::kUsed);
}

TEST_F(PoseExtrapolatorTest, ScansBackByTheClockJumpAreATimeJump) {
  OdometryParameters parameters;
  parameters.clock_jump = 0.4;
  extrapolator_ = PoseExtrapolator(parameters, {});
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  EXPECT_EQ(extrapolator_.checkStamp(11.0), ScanOutcome::kUsed);
  extrapolator_.beginScan(scanAt(11.0));
  EXPECT_EQ(extrapolator_.checkStamp(10.7), ScanOutcome::kOutOfOrder);
  EXPECT_EQ(extrapolator_.checkStamp(10.5), ScanOutcome::kStampOutlier);
  EXPECT_EQ(extrapolator_.checkStamp(10.51), ScanOutcome::kTimeJumpedBack);
}

TEST_F(PoseExtrapolatorTest, OdometryIsNewForTheMaximumGap) {
  OdometryParameters parameters;
  parameters.max_odometry_gap = 0.3;
  extrapolator_ = PoseExtrapolator(parameters, {});
  odometryUpTo(11.0);
  extrapolator_.reset(at(0.0), OdometryCalibration{});
  EXPECT_TRUE(extrapolator_.beginScan(scanAt(11.2)).odometry_is_new);
  EXPECT_FALSE(extrapolator_.beginScan(scanAt(11.4)).odometry_is_new);
}

}  // namespace
}  // namespace racecar_mcl
