#include "racecar_mcl/motion/gyro_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.025;         // s, between scans
constexpr double kOdometryError = 0.003;  // rad between two scans

/// A swerving car whose gyro measures `scale` of the turn, with noise (rad between two scans).
void swerve(GyroCalibration* gyro, double seconds, double scale, double noise = 1e-4) {
  Random random(3);
  for (double t = 0.0; t < seconds; t += kPeriod) {
    const double turn = -0.5 * (std::cos(3.0 * (t + kPeriod)) - std::cos(3.0 * t));
    Motion motion;
    motion.distance = 3.0 * kPeriod;
    motion.duration = kPeriod;
    motion.gyro = {scale * turn + noise * random.gaussian(), 0.0};
    gyro->learn(motion, turn + 0.002 * random.gaussian(), kOdometryError);
  }
}

Motion motionOf(double gyro_turn) {
  Motion motion;
  motion.duration = kPeriod;
  motion.gyro = {gyro_turn, 0.0};
  return motion;
}

TEST(GyroCalibration, IsUsedAfterATurn) {
  GyroCalibration gyro(100.0);
  EXPECT_EQ(gyro.use(), GyroUse::kNoData);
  swerve(&gyro, 0.1, 1.0);
  EXPECT_EQ(gyro.use(), GyroUse::kUnproven);
  swerve(&gyro, 3.0, 1.02);
  EXPECT_TRUE(gyro.isUsed());
  EXPECT_FALSE(gyro.isInDegrees());
  EXPECT_NEAR(gyro.turnOf(motionOf(0.102)), 0.1, 2e-3) << "the scale is learned";
}

TEST(GyroCalibration, NoiseIsNoTurn) {
  GyroCalibration gyro(100.0);
  Random random(1);
  for (int i = 0; i < 4000; ++i) {
    gyro.learn(motionOf(1e-4 * random.gaussian()), 0.002 * random.gaussian(), kOdometryError);
  }
  EXPECT_EQ(gyro.use(), GyroUse::kUnproven);
}

TEST(GyroCalibration, RecognisesDegrees) {
  GyroCalibration gyro(100.0);
  swerve(&gyro, 5.0, 180.0 / kPi);
  EXPECT_TRUE(gyro.isInDegrees());
  EXPECT_TRUE(gyro.isUsed());
  EXPECT_NEAR(gyro.turnOf(motionOf(10.0)), 10.0 * kPi / 180.0, 2e-3);
}

TEST(GyroCalibration, NoiseIsNotInDegrees) {
  GyroCalibration gyro(100.0);
  // The noise makes the ratio that of degrees.
  swerve(&gyro, 20.0, 15.0, 2.7);
  EXPECT_NEAR(gyro.ratio(), kPi / 180.0, 0.01);
  EXPECT_FALSE(gyro.isInDegrees());
  EXPECT_EQ(gyro.use(), GyroUse::kWrong);
}

TEST(GyroCalibration, IsNotUsedIfItTurnsAnotherWay) {
  for (const double scale : {-1.0, 0.1, 5.0}) {
    GyroCalibration gyro(100.0);
    swerve(&gyro, 5.0, scale);
    EXPECT_EQ(gyro.use(), GyroUse::kWrong) << scale;
    EXPECT_NEAR(gyro.ratio(), 1.0 / scale, 0.1 / std::abs(scale));
  }
}

TEST(GyroCalibration, IsNotUsedIfOdometryIsBetter) {
  GyroCalibration gyro(100.0);
  swerve(&gyro, 5.0, 1.0, 0.02);
  EXPECT_EQ(gyro.use(), GyroUse::kWorse);
  swerve(&gyro, 5.0, 1.0);
  EXPECT_EQ(gyro.use(), GyroUse::kUsed);
}

}  // namespace
}  // namespace racecar_mcl
