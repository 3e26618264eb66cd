#include "racecar_mcl/motion/calibrated_odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/expect_pose.h"

namespace racecar_mcl {
namespace {

constexpr double kSpeed = 3.0;  // m/s
double rateAt(double t) { return 1.5 * std::sin(3.0 * t); }

/// A swerving car with odometry that turns `scale` times as far, and a gyro.
class CalibratedOdometryTest : public testing::Test {
 protected:
  void driveUpTo(double seconds, double scale, bool gyro) {
    for (; now_ < seconds; now_ += 0.01) {
      if (gyro) odometry_.add(GyroSample{now_, rateAt(now_)});
      odometry_.add(OdometrySample{now_, {kSpeed, 0.0, scale * rateAt(now_ - 0.005)}, {}});
    }
  }

  static Pose2 trueMotion(double from, double to) {
    Pose2 pose;
    const int steps = 1000;
    const double dt = (to - from) / steps;
    for (int i = 0; i < steps; ++i) {
      pose = compose(pose, integrate({kSpeed, 0.0, rateAt(from + (i + 0.5) * dt)}, dt));
    }
    return pose;
  }

  /// Learns from scans without noise.
  void learnUpTo(double seconds, double scale, bool gyro) {
    for (; scan_ < seconds; scan_ += 0.05) {
      driveUpTo(scan_ + 0.06, scale, gyro);
      const Motion motion = odometry_.motion(odometry_.at(scan_), scan_ + 0.05);
      OdometryCalibration calibration = odometry_.calibration();
      const Eigen::Matrix2d covariance = 1e-3 * Eigen::Matrix2d::Identity();
      calibration.learn(
          motion,
          {between(motion.delta, trueMotion(scan_, scan_ + 0.05)), covariance, 0.5 * covariance},
          {true, true});
      odometry_.setCalibration(calibration);
    }
    driveUpTo(scan_ + 0.06, scale, gyro);
  }

  CalibratedOdometry odometry_;
  double now_ = 0.0;
  double scan_ = 0.1;
};

TEST_F(CalibratedOdometryTest, IsTheOdometryAtFirst) {
  driveUpTo(2.0, 1.0, false);
  const Motion motion = odometry_.motion(odometry_.at(1.0), 1.1);
  expectNear(motion.delta, trueMotion(1.0, 1.1), 2e-3, 2e-3);
  EXPECT_FALSE(motion.gyro);
  EXPECT_NEAR(motion.duration, 0.1, 1e-12);
}

TEST_F(CalibratedOdometryTest, MotionsAreMeasuredInBothDirections) {
  driveUpTo(2.0, 1.0, true);
  const Pose2 there = odometry_.motion(odometry_.at(1.0), 1.02).delta;
  const Pose2 back = odometry_.motion(odometry_.at(1.02), 1.0).delta;
  expectNear(compose(there, back), {}, 1e-9, 1e-9);
}

TEST_F(CalibratedOdometryTest, LearnsTheTurnsOfBadOdometry) {
  learnUpTo(20.0, 0.4, false);
  const Motion motion = odometry_.motion(odometry_.at(scan_), scan_ + 0.05);
  expectNear(motion.delta, trueMotion(scan_, scan_ + 0.05), 2e-3, 2e-3);
  EXPECT_FALSE(motion.turned_by_gyro);
}

TEST_F(CalibratedOdometryTest, TurnsByTheGyroWhichIsBetter) {
  learnUpTo(5.0, 0.4, true);
  const Motion motion = odometry_.motion(odometry_.at(scan_), scan_ + 0.05);
  EXPECT_TRUE(motion.turned_by_gyro);
  expectNear(motion.delta, trueMotion(scan_, scan_ + 0.05), 1e-3, 1e-3);
}

TEST_F(CalibratedOdometryTest, TurnsByOdometryIfTheGyroIsSilent) {
  learnUpTo(20.0, 0.4, true);
  const double silence = now_;
  driveUpTo(silence + 1.0, 0.4, false);
  const Motion motion = odometry_.motion(odometry_.at(silence + 0.5), silence + 0.55);
  EXPECT_FALSE(motion.turned_by_gyro);
  expectNear(motion.delta, trueMotion(silence + 0.5, silence + 0.55), 3e-3, 6e-3);
}

TEST_F(CalibratedOdometryTest, TheGyrosBiasIsMeasuredAtRest) {
  for (double t = 0.0; t < 3.0; t += 0.01) {
    odometry_.add(OdometrySample{t, {}, {}});
    odometry_.add(GyroSample{t, 0.05});
  }
  const Motion motion = odometry_.motion(odometry_.at(2.0), 2.9);
  ASSERT_TRUE(motion.gyro);
  EXPECT_NEAR(motion.gyro->turn, 0.0, 1e-6);
}

TEST_F(CalibratedOdometryTest, ASnapshotHasTheSameMotions) {
  learnUpTo(5.0, 0.4, true);
  const CalibratedOdometry part = odometry_.since(scan_);
  const Pose2 expected = odometry_.motion(odometry_.at(scan_), scan_ + 0.02).delta;
  expectNear(part.motion(part.at(scan_), scan_ + 0.02).delta, expected, 0.0, 0.0);
}

TEST(CalibratedOdometryParameters, DefineAJumpOfTheGyrosClock) {
  OdometryParameters parameters;
  parameters.clock_jump = 0.4;
  CalibratedOdometry odometry(parameters);
  odometry.add(GyroSample{10.0, 0.0});
  EXPECT_EQ(odometry.add(GyroSample{9.7, 0.0}), GyroOutcome::kOutOfOrder);
  EXPECT_EQ(odometry.add(GyroSample{9.5, 0.0}), GyroOutcome::kTimeJumpedBack);
}

TEST_F(CalibratedOdometryTest, TurnsHaveADelayOfTheirOwn) {
  driveUpTo(2.0, 1.0, false);
  OdometryErrors errors;
  errors.turn.delay = 0.1;
  OdometryCalibration calibration;
  calibration.resume(errors);
  const double later_turn = odometry_.at(1.1).odometry.turn;
  const double distance = odometry_.at(1.0).odometry.distance;
  odometry_.setCalibration(calibration);
  EXPECT_NEAR(odometry_.at(1.0).odometry.turn, later_turn, 1e-12);
  EXPECT_EQ(odometry_.at(1.0).odometry.distance, distance);
}

TEST(CalibratedOdometry, SpeedsAreThoseOfTheDelayBefore) {
  constexpr double kDelay = 0.05;  // s
  CalibratedOdometry odometry;
  for (double t = 0.01; t < 2.0; t += 0.01) {
    odometry.add(OdometrySample{t, {t - 0.005 - kDelay, 0.0, 0.0}, {}});  // accelerates by 1 m/s^2
  }
  OdometryCalibration calibration;
  calibration.resume({1.0, kDelay, {}});
  odometry.setCalibration(calibration);
  EXPECT_NEAR(odometry.motion(odometry.at(1.0), 1.1).delta.x, 0.105, 1e-4);
}

}  // namespace
}  // namespace racecar_mcl
