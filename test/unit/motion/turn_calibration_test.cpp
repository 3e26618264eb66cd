#include "racecar_mcl/motion/turn_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.025;  // s, between scans
constexpr double kSpeed = 3.0;     // m/s
const TurnErrors kErrors{0.3, 0.01, 0.65, 0.1, 0.2};

double trueTurnTo(double t) { return -0.5 * std::cos(3.0 * t); }
double trueRate(double t) { return 1.5 * std::sin(3.0 * t); }

/// A swerving car whose sensor measures `scale` of the turn, `delay` s late, less `offset` per
/// metre.
void swerve(TurnCalibration* calibration, double seconds, double scale, double delay = 0.0,
            double offset = 0.0) {
  for (double t = 0.0; t < seconds; t += kPeriod) {
    const double begin = t - delay + calibration->delay();
    const double end = begin + kPeriod;
    const double metres = kSpeed * kPeriod;
    const double measured = scale * (trueTurnTo(end) - trueTurnTo(begin)) - offset * metres;
    calibration->learn({measured, metres, scale * (trueRate(end) - trueRate(begin))},
                       trueTurnTo(t + kPeriod) - trueTurnTo(t), metres);
  }
}

TEST(TurnCalibration, FindsTheScaleOfOdometryFromTheCommandedSteering) {
  for (const double scale : {0.4, 0.97, 1.6}) {
    TurnCalibration calibration(kErrors, 100.0);
    swerve(&calibration, 10.0, scale);
    EXPECT_NEAR(calibration.scale(), 1.0 / scale, 0.15 / scale) << scale;
    swerve(&calibration, 60.0, scale);
    EXPECT_NEAR(calibration.scale(), 1.0 / scale, 0.02 / scale) << scale;
    EXPECT_LT(calibration.error(), 1e-3);
  }
}

TEST(TurnCalibration, FindsTheOffset) {
  TurnCalibration calibration(kErrors, 100.0);
  swerve(&calibration, 60.0, 1.0, 0.0, 0.02);
  EXPECT_NEAR(calibration.offset(), 0.02, 5e-3);
  EXPECT_NEAR(calibration.scale(), 1.0, 0.01);
}

TEST(TurnCalibration, FindsTheDelayBesidesTheScale) {
  for (const double delay : {0.1, -0.1}) {
    TurnCalibration calibration(kErrors, 100.0);
    swerve(&calibration, 60.0, 0.4, delay);
    EXPECT_NEAR(calibration.delay(), delay, 0.02);
    EXPECT_NEAR(calibration.scale(), 2.5, 0.1);
  }
}

TEST(TurnCalibration, LeavesOutTheFirstMetreAfterARestart) {
  TurnCalibration calibration(kErrors, 100.0);
  swerve(&calibration, 20.0, 0.97);
  const double before = calibration.scale();
  calibration.restart();
  // The scans turn a wrong start pose.
  for (int i = 0; i < 12; ++i) calibration.learn({0.0, 0.075, 0.0}, 0.05, 0.075);
  calibration.learn({0.0, 0.2, 0.0}, 0.05, 0.2);
  EXPECT_EQ(calibration.scale(), before);
  swerve(&calibration, 5.0, 0.5);
  EXPECT_GT(calibration.scale(), before + 0.02) << "it learns again";
}

TEST(TurnCalibration, StaysWithinItsLimits) {
  TurnCalibration calibration({0.3, 0.03, 0.5, 0.1, 0.05}, 100.0);
  swerve(&calibration, 60.0, 0.1, 0.5, 1.0);
  EXPECT_LE(calibration.scale(), 2.0);
  EXPECT_LE(calibration.offset(), 0.1);
  EXPECT_LE(calibration.delay(), 0.05);
}

TEST(TurnCalibration, MeasuresTheErrorAloneIfItIsConstant) {
  TurnCalibration calibration(kErrors, 0.0);
  swerve(&calibration, 10.0, 0.4);
  EXPECT_EQ(calibration.scale(), 1.0);
  EXPECT_EQ(calibration.delay(), 0.0);
  EXPECT_GT(calibration.error(), 0.01);
}

}  // namespace
}  // namespace racecar_mcl
