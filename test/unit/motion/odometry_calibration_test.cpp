#include "racecar_mcl/motion/odometry_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

Motion straight(double metres) {
  Motion motion;
  motion.delta = {metres, 0.0, 0.0};
  motion.distance = std::abs(metres);
  return motion;
}

Motion arc(double metres, double yaw) {
  Motion motion;
  motion.delta = integrate({metres, 0.0, yaw}, 1.0);
  motion.turn = yaw;
  motion.distance = std::abs(metres);
  motion.rotation = std::abs(yaw);
  return motion;
}

/// The correction of half of the error.
PoseCorrection halfOf(const Pose2& pose) {
  return {pose, 1e-3 * Eigen::Matrix2d::Identity(), 5e-4 * Eigen::Matrix2d::Identity()};
}

/// Each scan corrects half of the error.
void drive(OdometryCalibration* calibration, const Motion& odometry, const Motion& truth, int steps,
           bool map_is_complete = true) {
  Pose2 lead;  // the predicted pose in the frame of the true one
  for (int i = 0; i < steps; ++i) {
    const Motion corrected = calibration->correct(odometry);
    lead = between(truth.delta, compose(lead, corrected.delta));
    const Pose2 after = interpolate(lead, {}, 0.5);
    calibration->learn(corrected, halfOf(between(lead, after)), {map_is_complete, map_is_complete});
    lead = after;
  }
}

TEST(OdometryCalibration, EstimatesTheDistanceScale) {
  for (const double step : {0.1, -0.1}) {
    OdometryCalibration calibration({20.0});
    drive(&calibration, straight(1.03 * step), straight(step), 1000);
    EXPECT_NEAR(calibration.distanceScale(), 1.0 / 1.03, 1e-3);
    EXPECT_NEAR(calibration.odometryTurn().offset(), 0.0, 1e-9);
    EXPECT_NEAR(calibration.correct(straight(1.03)).delta.x, 1.0, 1e-3);
    EXPECT_NEAR(calibration.correct(straight(1.03)).distance, 1.0, 1e-3);
  }
}

TEST(OdometryCalibration, EstimatesAWrongScaleInTheFirstMetres) {
  for (const double error : {0.8, 1.2}) {
    OdometryCalibration calibration;
    drive(&calibration, straight(0.1 * error), straight(0.1), 300);
    EXPECT_NEAR(calibration.distanceScale(), 1.0 / error, 0.05);
  }
}

TEST(OdometryCalibration, EstimatesTheScaleSlowlyOnAnIncompleteMap) {
  OdometryCalibration calibration;
  drive(&calibration, straight(0.08), straight(0.1), 300, false);
  EXPECT_LT(calibration.distanceScale(), 1.08);
  EXPECT_GT(calibration.distanceScale(), 1.03);
}

TEST(OdometryCalibration, LaterErrorsOfTheScaleCountLess) {
  OdometryCalibration calibration;
  drive(&calibration, straight(0.1), straight(0.1), 2000);
  drive(&calibration, straight(0.08), straight(0.1), 50);
  EXPECT_LT(calibration.distanceScale(), 1.02);
}

TEST(OdometryCalibration, EstimatesTheSteeringOffsetOnAStraight) {
  OdometryCalibration calibration({20.0});
  drive(&calibration, straight(0.1), arc(0.1, 0.002), 1000);
  EXPECT_NEAR(calibration.odometryTurn().offset(), 0.02, 1e-3);
  EXPECT_NEAR(calibration.odometryTurn().scale(), 1.0, 1e-3);
}

TEST(OdometryCalibration, SeparatesTurnScaleAndSteeringOffset) {
  OdometryCalibration calibration({20.0});
  for (int lap = 0; lap < 100; ++lap) {
    drive(&calibration, arc(0.1, 0.105), arc(0.1, 0.1), 20);
    drive(&calibration, arc(0.1, -0.105), arc(0.1, -0.1), 20);
  }
  EXPECT_NEAR(calibration.odometryTurn().scale(), 1.0 / 1.05, 3e-3);
  EXPECT_NEAR(calibration.odometryTurn().offset(), 0.0, 3e-3);
}

/// A car that swerves and changes its speed, with odometry that is delayed by `delay` s.
void swerve(OdometryCalibration* calibration, double delay, double seconds) {
  constexpr double kPeriod = 0.025;  // s, between scans
  const auto poseAt = [](double t) {
    return Pose2{3.0 * t - 0.5 * std::cos(2.0 * t), 0.0, -0.5 * std::cos(3.0 * t)};
  };
  const auto twistAt = [](double t) {
    return Twist2{3.0 + std::sin(2.0 * t), 0.0, 1.5 * std::sin(3.0 * t)};
  };
  Pose2 lead;  // along the car and in heading
  for (double t = 0.0; t < seconds; t += kPeriod) {
    const double begin = t - delay + calibration->delay();
    const double end = begin + kPeriod;
    Motion motion;
    motion.delta = {poseAt(end).x - poseAt(begin).x, 0.0, poseAt(end).yaw - poseAt(begin).yaw};
    motion.distance = motion.delta.x;
    motion.turn = motion.delta.yaw;
    motion.twist_change = {twistAt(end).vx - twistAt(begin).vx, 0.0,
                           twistAt(end).wz - twistAt(begin).wz};
    motion = calibration->correct(motion);
    lead.x += motion.delta.x - (poseAt(t + kPeriod).x - poseAt(t).x);
    lead.yaw += motion.delta.yaw - (poseAt(t + kPeriod).yaw - poseAt(t).yaw);
    const Pose2 correction{-0.5 * lead.x, 0.0, -0.5 * lead.yaw};
    calibration->learn(motion, halfOf(correction), {true, true});
    lead.x += correction.x;
    lead.yaw += correction.yaw;
  }
}

TEST(OdometryCalibration, EstimatesTheDelay) {
  for (const double delay : {0.03, -0.01}) {
    OdometryCalibration calibration({100.0});
    swerve(&calibration, delay, 60.0);
    EXPECT_NEAR(calibration.delay(), delay, 1e-3);
    EXPECT_NEAR(calibration.distanceScale(), 1.0, 2e-3);
    EXPECT_NEAR(calibration.odometryTurn().scale(), 1.0, 2e-3);
  }
}

TEST(OdometryCalibration, EstimatesNoDelayAtConstantSpeed) {
  OdometryCalibration calibration({20.0});
  drive(&calibration, arc(0.103, 0.105), arc(0.1, 0.1), 1000);
  EXPECT_EQ(calibration.delay(), 0.0);
}

TEST(OdometryCalibration, StaysWithinItsLimits) {
  OdometryCalibration calibration({1.0});
  drive(&calibration, arc(1.0, 1.0), arc(0.5, 0.2), 1000);
  EXPECT_GE(calibration.distanceScale(), 0.65);
  EXPECT_GE(calibration.odometryTurn().scale(), 1.0 / 1.65);
  EXPECT_GE(calibration.odometryTurn().offset(), -0.1);
  swerve(&calibration, 0.5, 60.0);
  EXPECT_LE(calibration.delay(), 0.1);
}

TEST(OdometryCalibration, EstimatesNothingWhileStationary) {
  OdometryCalibration calibration({20.0});
  calibration.learn(straight(0.0), halfOf({0.1, 0.1, 0.1}), {true, true});
  EXPECT_EQ(calibration.distanceScale(), 1.0);
  EXPECT_EQ(calibration.odometryTurn().scale(), 1.0);
  EXPECT_EQ(calibration.odometryTurn().offset(), 0.0);
  EXPECT_EQ(calibration.delay(), 0.0);
}

TEST(OdometryCalibration, EstimatesNothingIfDisabled) {
  OdometryCalibration calibration({0.0});
  drive(&calibration, straight(0.11), straight(0.1), 1000);
  swerve(&calibration, 0.03, 10.0);
  EXPECT_EQ(calibration.distanceScale(), 1.0);
  EXPECT_EQ(calibration.delay(), 0.0);
}

TEST(OdometryCalibration, ContinuesWithTheRateOfTheEarlierRun) {
  for (const double scale_distance : {0.0, 100.0}) {
    OdometryCalibration calibration;
    calibration.resume({1.1, 0.0, {}, scale_distance});
    drive(&calibration, straight(0.1), straight(0.1), 50);
    EXPECT_EQ(calibration.distanceScale() > 1.08, scale_distance == 100.0);
  }
}

TEST(OdometryCalibration, ResumesWithinItsLimits) {
  OdometryCalibration before({20.0}), after({20.0});
  drive(&before, straight(0.11), straight(0.1), 1000);
  swerve(&before, 0.03, 10.0);
  after.resume(before.errors());
  EXPECT_NE(before.distanceScale(), 1.0);
  EXPECT_EQ(after.distanceScale(), before.distanceScale());
  EXPECT_EQ(after.delay(), before.delay());
  EXPECT_EQ(after.odometryTurn().scale(), before.odometryTurn().scale());
  EXPECT_EQ(after.odometryTurn().offset(), before.odometryTurn().offset());
  EXPECT_EQ(after.odometryTurn().delay(), before.odometryTurn().delay());
  after.resume({9.0, 9.0, {9.0, 9.0, 9.0}});
  EXPECT_NEAR(after.distanceScale(), 1.35, 1e-9);
  EXPECT_NEAR(after.delay(), 0.1, 1e-9);
  EXPECT_NEAR(after.odometryTurn().scale(), 1.0 / 0.35, 1e-9);
  EXPECT_NEAR(after.odometryTurn().offset(), 0.1, 1e-9);
  EXPECT_NEAR(after.odometryTurn().delay(), 0.2, 1e-9);
}

TEST(OdometryCalibration, IsNotResumedIfDisabled) {
  OdometryCalibration calibration({0.0});
  calibration.resume({1.1, 0.05, {1.2, 0.01, 0.1}});
  EXPECT_EQ(calibration.distanceScale(), 1.0);
  EXPECT_EQ(calibration.delay(), 0.0);
  EXPECT_EQ(calibration.odometryTurn().scale(), 1.0);
}

TEST(OdometryCalibration, RejectsInvalidDistances) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double distance : {-1.0, 0.5, 2e6, nan}) {
    EXPECT_THROW(validate(OdometryCalibrationParameters{distance}), ParameterError) << distance;
    EXPECT_THROW(OdometryCalibration{OdometryCalibrationParameters{distance}}, ParameterError);
  }
  EXPECT_NO_THROW(validate(OdometryCalibrationParameters{0.0}));
}

TEST(OdometryCalibration, TheGyroIsNotCalibratedIfDisabled) {
  const auto turnByAGyroThatIsFivePercentShort = [](double distance) {
    OdometryCalibration calibration({distance});
    Motion motion;
    motion.distance = motion.delta.x = 0.075;
    motion.duration = 0.025;
    Motion probe = motion;
    probe.gyro = {1.0, 0.0};
    for (int scan = 0; scan < 400; ++scan) {
      const double turn = 0.05 * std::sin(0.2 * scan);
      motion.gyro = {turn, 0.0};
      motion.turn = motion.delta.yaw = 0.5 * turn;
      calibration.learn(motion, halfOf({0.0, 0.0, 1.05 * turn - motion.delta.yaw}), {true, true});
    }
    return calibration.gyro().turnOf(probe);
  };
  EXPECT_GT(turnByAGyroThatIsFivePercentShort(100.0), 1.01);
  EXPECT_DOUBLE_EQ(turnByAGyroThatIsFivePercentShort(0.0), 1.0) << "off";
}

}  // namespace
}  // namespace racecar_mcl
