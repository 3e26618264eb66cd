#include "racecar_mcl/motion/slip_compensation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.025;  // s
constexpr double kSpeed = 3.0;     // m/s
constexpr double kTurnRate = 1.5;  // rad/s

Motion motionAt(double speed, double turn_rate = 0.0, double seconds = kPeriod) {
  Motion motion;
  motion.delta = integrate({speed, 0.0, turn_rate}, seconds);
  motion.distance = std::abs(speed) * seconds;
  motion.rotation = std::abs(turn_rate) * seconds;
  motion.duration = motion.seconds = seconds;
  return motion;
}

Pose2 moved(double speed, double turn_rate = 0.0, double seconds = kPeriod) {
  return motionAt(speed, turn_rate, seconds).delta;
}

class SlipCompensationTest : public testing::Test {
 protected:
  /// A second at constant speed, with right odometry.
  SlipCompensationTest() {
    for (int scan = 0; scan < 40; ++scan) learn(kSpeed, kSpeed, kTurnRate, kTurnRate);
  }

  void learn(double odometry_speed, double speed, double odometry_turn_rate = 0.0,
             double turn_rate = 0.0) {
    compensation_.learn(motionAt(odometry_speed, odometry_turn_rate), moved(speed, turn_rate));
  }

  Motion corrected(const Motion& odometry) const {
    return compensation_.correct(odometry, MotionModelParameters{});
  }

  bool isReplaced(double odometry_speed) const {
    return corrected(motionAt(odometry_speed)).compensation.has_value();
  }

  SlipCompensation compensation_;
};

TEST_F(SlipCompensationTest, KeepsTheMotionOfRightOdometry) {
  const Motion odometry = motionAt(kSpeed, kTurnRate);
  const Motion motion = corrected(odometry);
  EXPECT_FALSE(motion.compensation || motion.covariance);
  EXPECT_EQ(motion.delta.x, odometry.delta.x);
  EXPECT_FALSE(compensation_.twist());
}

TEST_F(SlipCompensationTest, KeepsAccelerationsThatTyresAllow) {
  double speed = kSpeed;
  for (int scan = 0; scan < 400; ++scan) {
    speed += (scan / 20 % 2 == 0 ? 10.0 : -10.0) * kPeriod;
    ASSERT_FALSE(isReplaced(speed)) << scan;
    learn(speed, speed);
  }
}

TEST_F(SlipCompensationTest, ScansAloneDoNotReplaceAMotion) {
  // As on a map that pulls the estimate along a smooth course.
  for (int scan = 0; scan < 80; ++scan) {
    ASSERT_FALSE(isReplaced(kSpeed)) << scan;
    learn(kSpeed, kSpeed + 3.0 * std::sin(0.2 * scan));
  }
}

TEST_F(SlipCompensationTest, KeepsTheMotionOfNoisyOdometry) {
  compensation_.reset();
  Random random(1);
  for (int scan = 0; scan < 400; ++scan) {
    const double speed = kSpeed + 0.3 * random.gaussian();
    ASSERT_FALSE(isReplaced(speed)) << scan;
    learn(speed, 0.8 * kSpeed);
  }
  EXPECT_TRUE(isReplaced(-0.5));
}

TEST_F(SlipCompensationTest, ContinuesAtTheSpeedOfTheCarWhileOdometryIsFrozen) {
  for (int scan = 0; scan < 80; ++scan) {
    const Motion motion = corrected(motionAt(0.0));
    ASSERT_TRUE(motion.compensation);
    ASSERT_NEAR(motion.compensation->vx, kSpeed, 0.4) << scan;
    ASSERT_NEAR(motion.compensation->wz, kTurnRate, 1e-6) << scan;
    ASSERT_NEAR(motion.delta.x, kSpeed * kPeriod, 0.01) << scan;
    learn(0.0, kSpeed, 0.0, kTurnRate);
    ASSERT_TRUE(compensation_.twist());
    ASSERT_NEAR(compensation_.twist()->vx, kSpeed, 0.4);
  }
  EXPECT_FALSE(isReplaced(kSpeed)) << "the odometry is back";
}

TEST_F(SlipCompensationTest, ItsCovarianceIncludesTheMotionOfTheOdometry) {
  const Motion motion = corrected(motionAt(0.0));
  ASSERT_TRUE(motion.covariance);
  EXPECT_GE(std::sqrt((*motion.covariance)(0, 0)), motion.delta.x);
  EXPECT_GE(std::sqrt((*motion.covariance)(2, 2)), motion.delta.yaw);
  EXPECT_EQ(motion.distance, motion.compensation->vx * kPeriod);
  EXPECT_EQ(motion.seconds, kPeriod);
}

TEST_F(SlipCompensationTest, FollowsSpinningWheelsAndWrongScales) {
  for (const double factor : {0.6, 1.5}) {
    SCOPED_TRACE(factor);
    for (int scan = 0; scan < 40; ++scan) {
      ASSERT_TRUE(isReplaced(factor * kSpeed)) << scan;
      learn(factor * kSpeed, kSpeed);
    }
  }
}

TEST_F(SlipCompensationTest, TheOdometryIsRightWhereScansSayThatTheCarHasStopped) {
  for (int scan = 0; scan < 16; ++scan) learn(0.0, 0.0);
  EXPECT_FALSE(isReplaced(0.0));
  EXPECT_FALSE(compensation_.twist());
}

TEST_F(SlipCompensationTest, KeepsTheTurnOfTheGyro) {
  Motion odometry = motionAt(0.0);
  odometry.delta.yaw = 0.02;
  odometry.turned_by_gyro = true;
  const Motion motion = corrected(odometry);
  ASSERT_TRUE(motion.compensation);
  EXPECT_DOUBLE_EQ(motion.delta.yaw, 0.02);
}

TEST_F(SlipCompensationTest, StopsAfterHalfASecond) {
  learn(0.0, kSpeed);
  const double limit = corrected(motionAt(0.0, 0.0, 0.5)).delta.x;
  EXPECT_GT(limit, 1.0);
  EXPECT_EQ(corrected(motionAt(0.0, 0.0, 5.0)).delta.x, limit);
}

TEST_F(SlipCompensationTest, LidarsThatScanShortlyAfterEachOtherMayDiffer) {
  for (int pair = 0; pair < 100; ++pair) {
    for (const double apart : {0.005, 0.0}) {
      for (const bool second : {true, false}) {
        const double seconds = second ? apart : 0.05 - apart;
        const Motion odometry = motionAt(kSpeed, 0.0, seconds);
        ASSERT_FALSE(corrected(odometry).compensation) << pair;
        Pose2 step = odometry.delta;
        step.x += second ? 0.02 : -0.02;
        compensation_.learn(odometry, step);
      }
    }
  }
}

TEST_F(SlipCompensationTest, AScanAtTheStampOfAnotherHasTheTwistOfTheCar) {
  EXPECT_FALSE(corrected(motionAt(0.0, 0.0, 0.0)).compensation);
  learn(0.0, kSpeed, 0.0, kTurnRate);
  const Motion motion = corrected(motionAt(0.0, 0.0, 0.0));
  ASSERT_TRUE(motion.compensation);
  EXPECT_NEAR(motion.compensation->vx, kSpeed, 0.4);
  EXPECT_EQ(motion.delta.x, 0.0);
  EXPECT_FALSE(motion.covariance);
}

TEST_F(SlipCompensationTest, AlsoDrivesInReverse) {
  compensation_.reset();
  for (int scan = 0; scan < 40; ++scan) learn(-kSpeed, -kSpeed);
  EXPECT_FALSE(isReplaced(-kSpeed));
  const Motion motion = corrected(motionAt(0.0));
  ASSERT_TRUE(motion.compensation);
  EXPECT_NEAR(motion.delta.x, -kSpeed * kPeriod, 0.01);
  EXPECT_GT(motion.distance, 0.0);
}

TEST_F(SlipCompensationTest, EstimatesThatAreFarApartGiveNoSpeed) {
  for (int scan = 0; scan < 10; ++scan) {
    const Motion odometry = motionAt(0.4, 0.0, 1.0);
    EXPECT_FALSE(corrected(odometry).compensation) << scan;
    Pose2 step = odometry.delta;
    step.x += scan % 2 == 0 ? 0.5 : -0.3;
    compensation_.learn(odometry, step);
  }
}

TEST_F(SlipCompensationTest, ChangesNothingWithoutATimeOrAScan) {
  Motion motion = motionAt(0.0);
  for (const double duration : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    motion.duration = duration;
    EXPECT_FALSE(corrected(motion).compensation) << duration;
  }
  EXPECT_TRUE(isReplaced(0.0));
  compensation_.reset();
  EXPECT_FALSE(isReplaced(0.0));
}

TEST_F(SlipCompensationTest, ForgetsTheSpeedWhenTheClockIsSetBack) {
  for (const double duration : {-5.0, std::numeric_limits<double>::quiet_NaN()}) {
    learn(kSpeed, kSpeed);
    ASSERT_TRUE(isReplaced(0.0));
    Motion motion = motionAt(kSpeed);
    motion.duration = duration;
    compensation_.learn(motion, {100.0, 0.0, 0.0});
    EXPECT_FALSE(isReplaced(0.0)) << duration;
  }
}

}  // namespace
}  // namespace racecar_mcl
