#include "racecar_mcl/motion/odometry_buffer.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/random.h"
#include "support/expect_pose.h"

namespace racecar_mcl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kPeriod = 0.02;  // s, a car's odometry at 50 Hz

void expectSame(const OdometryState& a, const OdometryState& b) {
  EXPECT_EQ(a.base_in_odom.x, b.base_in_odom.x);
  EXPECT_EQ(a.base_in_odom.y, b.base_in_odom.y);
  EXPECT_EQ(a.base_in_odom.yaw, b.base_in_odom.yaw);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.rotation, b.rotation);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.messages, b.messages);
}

OdometrySample twistAt(double stamp, const Twist2& twist) { return {stamp, twist, {}}; }

/// `count` messages of one twist after a first one at `start`.
OdometryBuffer driven(const Twist2& twist, int count, double start = 0.0) {
  OdometryBuffer history;
  for (int i = 0; i <= count; ++i) history.add(twistAt(start + i * kPeriod, twist));
  return history;
}

Motion motionOver(const OdometryBuffer& history, double from, double to) {
  return motionBetween(history.at(from), history.at(to));
}

TEST(OdometryBuffer, IsStationaryWhileEmpty) {
  const OdometryBuffer history;
  EXPECT_TRUE(history.empty());
  expectSame(history.at(3.0), OdometryState{});
}

TEST(OdometryBuffer, IntegratesTwistsBetweenMessages) {
  const OdometryBuffer history = driven({2.0, 0.5, 0.0}, 50);
  expectNear(history.at(1.0).base_in_odom, {2.0, 0.5, 0.0});
  EXPECT_NEAR(history.at(1.0).messages, 50.0, 1e-9);
}

TEST(OdometryBuffer, ATwistIsValidForTheTimeSinceTheLastMessage) {
  OdometryBuffer history;
  history.add(twistAt(0.0, {5.0, 0.0, 0.0}));
  history.add(twistAt(0.1, {1.0, 0.0, 0.0}));
  history.add(twistAt(0.4, {2.0, 0.0, 0.0}));
  EXPECT_NEAR(history.at(0.4).base_in_odom.x, 0.1 * 1.0 + 0.3 * 2.0, 1e-12);
}

TEST(OdometryBuffer, DrivesArcsNotChords) {
  // A quarter turn at 1 m/s on a circle of 2 m radius, in only four messages.
  OdometryBuffer history;
  for (int i = 0; i <= 4; ++i) history.add(twistAt(i * kPi / 4, {1.0, 0.0, 0.5}));
  expectNear(history.at(kPi).base_in_odom, {2.0, 2.0, kPi / 2});
  EXPECT_NEAR(history.at(kPi).distance, kPi, 1e-9);
  EXPECT_NEAR(history.at(kPi).rotation, kPi / 2, 1e-9);
}

TEST(OdometryBuffer, InterpolatesAlongTheArc) {
  const Twist2 twist{3.0, -0.2, 1.5};
  const OdometryBuffer history = driven(twist, 100);
  for (const double stamp : {0.001, 0.0333, 0.5, 0.9999, 1.987}) {
    expectNear(history.at(stamp).base_in_odom, integrate(twist, stamp));
    EXPECT_NEAR(history.at(stamp).messages, stamp / kPeriod, 1e-9);
  }
}

TEST(OdometryBuffer, IsContinuousAcrossMessages) {
  OdometryBuffer history;
  Random random(1);
  for (int i = 0; i <= 20; ++i) {
    history.add(twistAt(i * kPeriod, {random.uniform(-3, 3), 0.0, random.uniform(-2, 2)}));
  }
  for (int i = 1; i < 20; ++i) {
    expectNear(history.at(i * kPeriod - 1e-9).base_in_odom,
               history.at(i * kPeriod + 1e-9).base_in_odom, 1e-7);
  }
}

TEST(OdometryBuffer, ExtrapolatesTheLastTwistForALimitedTime) {
  const OdometryBuffer history = driven({2.0, 0.0, 0.0}, 50);
  const double limit = OdometryParameters{}.max_odometry_extrapolation;
  EXPECT_NEAR(history.at(1.0 + limit / 2).base_in_odom.x, 2.0 + 2.0 * limit / 2, 1e-9);
  EXPECT_NEAR(history.at(1.0 + limit).base_in_odom.x, 2.0 + 2.0 * limit, 1e-9);
  EXPECT_NEAR(history.at(1e9).base_in_odom.x, 2.0 + 2.0 * limit, 1e-9);
  EXPECT_NEAR(history.at(kInf).base_in_odom.x, 2.0 + 2.0 * limit, 1e-9);
}

TEST(OdometryBuffer, ReturnsTheOldestStateForEarlierTimes) {
  OdometryBuffer history = driven({1.0, 0.0, 0.0}, 5, 100.0);
  expectSame(history.at(99.0), OdometryState{});
  expectSame(history.at(-kInf), OdometryState{});
  // The buffer holds seconds, not minutes, so that its memory is bounded.
  history = driven({1.0, 0.0, 0.0}, 3000);
  EXPECT_NEAR(history.at(55.0).base_in_odom.x, 55.0, 1e-6);
  EXPECT_GT(history.at(0.0).base_in_odom.x, 45.0);
}

TEST(OdometryBuffer, TreatsNaNAsTheNewestTime) {
  const OdometryBuffer history = driven({1.0, 0.0, 0.0}, 50);
  expectSame(history.at(kNan), history.at(1.0));
}

TEST(OdometryBuffer, CountsReverseAsDistanceAndBothTurnsAsRotation) {
  OdometryBuffer history;
  history.add(twistAt(0.0, {}));
  history.add(twistAt(1.0, {1.0, 0.0, 0.5}));
  history.add(twistAt(2.0, {-1.0, 0.0, -0.5}));
  const Motion motion = motionOver(history, 0.0, 2.0);
  EXPECT_NEAR(motion.delta.yaw, 0.0, 1e-12);
  EXPECT_NEAR(motion.distance, 2.0, 1e-12);
  EXPECT_NEAR(motion.rotation, 1.0, 1e-12);
  EXPECT_NEAR(motion.messages, 2.0, 1e-12);
}

TEST(OdometryBuffer, CountsOnlyTheTimeSpentMoving) {
  OdometryBuffer history;
  history.add(twistAt(0.0, {}));
  history.add(twistAt(0.5, {1.0, 0.0, 0.0}));
  history.add(twistAt(1.0, {1e-4, 0.0, -1e-4}));
  history.add(twistAt(1.5, {0.0, 0.0, 0.3}));
  EXPECT_NEAR(motionOver(history, 0.0, 1.5).seconds, 1.0, 1e-12);
}

TEST(OdometryBuffer, GivesMotionInTheFrameOfTheEarlierPose) {
  OdometryBuffer history;
  history.add(twistAt(0.0, {}));
  history.add(twistAt(1.0, {0.0, 0.0, kPi / 2}));
  history.add(twistAt(2.0, {1.0, 0.0, 0.0}));
  expectNear(motionOver(history, 1.0, 2.0).delta, {1.0, 0.0, 0.0});
  expectNear(motionOver(history, 0.0, 2.0).delta, {0.0, 1.0, kPi / 2});
}

TEST(OdometryBuffer, MotionBackInTimeIsTheInverseAndHasNoLength) {
  const OdometryBuffer history = driven({2.0, 0.0, 1.0}, 50);
  const Motion forward = motionOver(history, 0.4, 0.8);
  const Motion backward = motionOver(history, 0.8, 0.4);
  expectNear(compose(forward.delta, backward.delta), {});
  EXPECT_EQ(backward.distance, 0.0);
  EXPECT_EQ(backward.rotation, 0.0);
  EXPECT_EQ(backward.seconds, 0.0);
  EXPECT_EQ(backward.messages, 0.0);
}

TEST(OdometryBuffer, IntegratesATwistOverAGapOnlyForTheLimit) {
  OdometryBuffer history;
  history.add(twistAt(0.0, {2.0, 0.0, 0.0}));
  EXPECT_EQ(history.add(twistAt(9.98, {2.0, 0.0, 0.0})), OdometryOutcome::kStampOutlier);
  EXPECT_EQ(history.add(twistAt(10.0, {2.0, 0.0, 0.0})), OdometryOutcome::kGap);
  EXPECT_NEAR(history.at(9.98).base_in_odom.x, 2.0 * OdometryParameters{}.max_odometry_gap, 1e-9);
  EXPECT_NEAR(history.at(10.0).base_in_odom.x - history.at(9.98).base_in_odom.x, 0.04, 1e-9);
  // The twist itself is unchanged.
  EXPECT_EQ(history.newestTwist().vx, 2.0);
  EXPECT_NEAR(history.at(10.1).base_in_odom.x - history.at(10.0).base_in_odom.x, 0.2, 1e-9);
}

TEST(OdometryBuffer, IntegratesNothingOverAStepOfTheClock) {
  OdometryBuffer history;
  history.add(twistAt(0.0, {3.0, 0.0, 0.0}));
  history.add(twistAt(0.02, {3.0, 0.0, 0.0}));
  const OdometryState before = history.at(0.02);
  history.add(twistAt(100.04, {3.0, 0.0, 0.0}));
  history.add(twistAt(100.06, {3.0, 0.0, 0.0}));
  EXPECT_NEAR(motionBetween(before, history.at(100.06)).delta.x, 0.06, 1e-6);
}

TEST(OdometryBuffer, TwoLongGapsInARowAreGaps) {
  OdometryBuffer history = driven({1.0, 0.0, 0.0}, 50);
  history.add(twistAt(2.6, {1.0, 0.0, 0.0}));
  EXPECT_EQ(history.add(twistAt(4.2 + 1e-7, {1.0, 0.0, 0.0})), OdometryOutcome::kGap);
  const double limit = OdometryParameters{}.max_odometry_gap;
  EXPECT_NEAR(history.at(4.2).base_in_odom.x - history.at(1.0).base_in_odom.x, 2.0 * limit, 1e-6);
}

TEST(OdometryBuffer, DropsBadMessagesWithoutAChange) {
  OdometryBuffer history = driven({2.0, 0.0, 0.3}, 50);
  const OdometryState before = history.at(1.1);
  const struct {
    OdometrySample sample;
    OdometryOutcome outcome;
  } bad[] = {{twistAt(1.0, {9.0, 0.0, 0.0}), OdometryOutcome::kRepeatedStamp},
             {twistAt(0.99, {9.0, 0.0, 0.0}), OdometryOutcome::kOutOfOrder},
             {twistAt(0.01, {9.0, 0.0, 0.0}), OdometryOutcome::kOutOfOrder},
             {twistAt(kNan, {}), OdometryOutcome::kNotFinite},
             {twistAt(kInf, {}), OdometryOutcome::kNotFinite},
             {twistAt(1e308, {}), OdometryOutcome::kNotFinite},
             {twistAt(-1e308, {}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {kNan, 0.0, 0.0}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {0.0, kInf, 0.0}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {0.0, 0.0, -kInf}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {1e200, 0.0, 0.0}), OdometryOutcome::kImplausible},
             {twistAt(1.02, {0.0, 0.0, -1e4}), OdometryOutcome::kImplausible}};
  for (const auto& [sample, outcome] : bad) {
    EXPECT_EQ(history.add(sample), outcome) << toString(outcome);
    expectSame(history.at(1.1), before);
    EXPECT_EQ(history.newestStamp(), 1.0);
  }
  EXPECT_EQ(history.add(twistAt(1.02, {2.0, 0.0, 0.3})), OdometryOutcome::kUsed);
}

TEST(OdometryBuffer, ContinuesIntegratingAfterAClockJump) {
  OdometryBuffer history = driven({1.0, 0.0, 0.2}, 500, 100.0);
  const OdometryState before = history.at(110.0);
  EXPECT_EQ(history.add(twistAt(99.98, {1.0, 0.0, 0.2})), OdometryOutcome::kStampOutlier);
  EXPECT_EQ(history.add(twistAt(100.0, {1.0, 0.0, 0.2})), OdometryOutcome::kTimeJumpedBack);
  EXPECT_EQ(history.newestStamp(), 100.0);
  expectSame(history.at(99.98), before);
  history.add(twistAt(100.5, {1.0, 0.0, 0.2}));
  expectNear(motionBetween(before, history.at(100.5)).delta, integrate({1.0, 0.0, 0.2}, 0.52));
}

TEST(OdometryBuffer, EveryLoopOfABagGivesTheSameMotion) {
  OdometryBuffer history;
  Pose2 first_round;
  for (int round = 0; round < 3; ++round) {
    OdometryState start;
    for (int i = 0; i <= 200; ++i) {
      const OdometryOutcome outcome =
          history.add(twistAt(50.0 + i * kPeriod, {2.0, 0.0, std::sin(0.1 * i)}));
      const OdometryOutcome jump[] = {OdometryOutcome::kStampOutlier,
                                      OdometryOutcome::kTimeJumpedBack};
      EXPECT_EQ(outcome, i < 2 && round > 0 ? jump[i] : OdometryOutcome::kUsed);
      if (i == 1) start = history.at(50.0 + kPeriod);
    }
    const Pose2 moved = motionBetween(start, history.at(54.0)).delta;
    if (round == 0) first_round = moved;
    expectNear(moved, first_round);
  }
}

TEST(OdometryBuffer, OneWrongStampChangesNothing) {
  for (const double wrong : {-1e3, -30.0, -1.1, 1.5, 30.0, 1e9}) {
    OdometryBuffer history = driven({4.0, 0.0, 0.5}, 100);
    const OdometryState before = history.at(2.1), past = history.at(0.5);
    EXPECT_EQ(history.add(twistAt(2.02 + wrong, {4.0, 0.0, 0.5})), OdometryOutcome::kStampOutlier);
    EXPECT_EQ(history.newestStamp(), 2.0);
    expectSame(history.at(2.1), before);
    expectSame(history.at(0.5), past);
    EXPECT_EQ(history.add(twistAt(2.04, {4.0, 0.0, 0.5})), OdometryOutcome::kUsed);
    expectNear(history.at(2.04).base_in_odom, integrate({4.0, 0.0, 0.5}, 2.04));
  }
}

TEST(OdometryBuffer, ResetRemovesMessagesButKeepsTheState) {
  OdometryBuffer history = driven({1.0, 0.0, 0.0}, 50, 100.0);
  history.reset();
  EXPECT_TRUE(history.empty());
  EXPECT_NEAR(history.at(5.0).base_in_odom.x, 1.0, 1e-9);
  history.reset();
  EXPECT_EQ(history.add(twistAt(5.0, {1.0, 0.0, 0.0})), OdometryOutcome::kUsed);
  history.add(twistAt(5.5, {1.0, 0.0, 0.0}));
  EXPECT_NEAR(history.at(5.5).base_in_odom.x, 1.5, 1e-9);
}

TEST(OdometryOutcome, EachHasItsOwnText) {
  EXPECT_NE(toString(OdometryOutcome::kImplausible), toString(OdometryOutcome::kNotFinite));
  EXPECT_NE(toString(OdometryOutcome::kRepeatedStamp), toString(OdometryOutcome::kOutOfOrder));
  EXPECT_NE(toString(OdometryOutcome::kStampOutlier), toString(OdometryOutcome::kOutOfOrder));
  EXPECT_NE(toString(OdometryOutcome::kGap), toString(OdometryOutcome::kTimeJumpedBack));
}

TEST(OdometryParameters, RejectValuesOutOfRange) {
  for (const double bad : {-0.1, kNan, kInf}) {
    OdometryParameters gap, extrapolation, jump;
    gap.max_odometry_gap = bad;
    extrapolation.max_odometry_extrapolation = bad;
    jump.clock_jump = bad;
    for (const OdometryParameters& parameters : {gap, extrapolation, jump}) {
      EXPECT_THROW(validate(parameters), ParameterError);
      EXPECT_THROW(OdometryBuffer{parameters}, ParameterError);
    }
  }
  OdometryParameters none;
  none.max_odometry_extrapolation = 0.0;
  EXPECT_NO_THROW(validate(none));
  none.max_odometry_gap = 0.0;
  EXPECT_THROW(validate(none), ParameterError);
}

TEST(OdometryParameters, LimitTheMotionOverAGap) {
  OdometryParameters parameters;
  parameters.max_odometry_gap = 0.3;
  OdometryBuffer history(parameters);
  history.add(twistAt(0.0, {2.0, 0.0, 0.0}));
  EXPECT_EQ(history.add(twistAt(0.48, {2.0, 0.0, 0.0})), OdometryOutcome::kStampOutlier);
  EXPECT_EQ(history.add(twistAt(0.5, {2.0, 0.0, 0.0})), OdometryOutcome::kGap);
  EXPECT_NEAR(history.at(0.48).base_in_odom.x, 0.6, 1e-9);
}

TEST(OdometryParameters, LimitTheExtrapolation) {
  OdometryParameters parameters;
  parameters.max_odometry_extrapolation = 0.1;
  OdometryBuffer history(parameters);
  history.add(twistAt(0.0, {2.0, 0.0, 0.0}));
  EXPECT_NEAR(history.at(1.0).base_in_odom.x, 0.2, 1e-9);
}

TEST(OdometryParameters, DefineAJumpOfTheClock) {
  OdometryParameters parameters;
  parameters.clock_jump = 0.4;
  OdometryBuffer history(parameters);
  const auto add = [&](double stamp) { return history.add(twistAt(stamp, {2.0, 0.0, 0.0})); };
  add(10.0);
  EXPECT_EQ(add(9.7), OdometryOutcome::kOutOfOrder);
  history.setParameters({});  // it is not changed
  EXPECT_EQ(add(9.5), OdometryOutcome::kStampOutlier);
  EXPECT_EQ(add(9.52), OdometryOutcome::kTimeJumpedBack);
}

}  // namespace
}  // namespace racecar_mcl
