#include "racecar_mcl/odometry.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/random.h"
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
OdometryHistory driven(const Twist2& twist, int count, double start = 0.0) {
  OdometryHistory history;
  for (int i = 0; i <= count; ++i) history.add(twistAt(start + i * kPeriod, twist));
  return history;
}

Motion motionOver(const OdometryHistory& history, double from, double to) {
  return motionBetween(history.at(from), history.at(to));
}

TEST(OdometryHistory, StandsStillWhileEmpty) {
  const OdometryHistory history;
  EXPECT_TRUE(history.empty());
  expectSame(history.at(3.0), OdometryState{});
}

TEST(OdometryHistory, SumsTwistTimesTimeBetweenMessages) {
  const OdometryHistory history = driven({2.0, 0.5, 0.0}, 50);
  expectNear(history.at(1.0).base_in_odom, {2.0, 0.5, 0.0});
  EXPECT_NEAR(history.at(1.0).messages, 50.0, 1e-9);
}

TEST(OdometryHistory, ATwistHoldsForTheTimeSinceTheMessageBeforeIt) {
  OdometryHistory history;
  history.add(twistAt(0.0, {5.0, 0.0, 0.0}));
  history.add(twistAt(0.1, {1.0, 0.0, 0.0}));
  history.add(twistAt(0.4, {2.0, 0.0, 0.0}));
  EXPECT_NEAR(history.at(0.4).base_in_odom.x, 0.1 * 1.0 + 0.3 * 2.0, 1e-12);
}

TEST(OdometryHistory, DrivesArcsNotChords) {
  // A quarter turn at 1 m/s on a circle of 2 m radius, in only four messages.
  OdometryHistory history;
  for (int i = 0; i <= 4; ++i) history.add(twistAt(i * kPi / 4, {1.0, 0.0, 0.5}));
  expectNear(history.at(kPi).base_in_odom, {2.0, 2.0, kPi / 2});
  EXPECT_NEAR(history.at(kPi).distance, kPi, 1e-9);
  EXPECT_NEAR(history.at(kPi).rotation, kPi / 2, 1e-9);
}

TEST(OdometryHistory, InterpolatesAlongTheArc) {
  const Twist2 twist{3.0, -0.2, 1.5};
  const OdometryHistory history = driven(twist, 100);
  for (const double stamp : {0.001, 0.0333, 0.5, 0.9999, 1.987}) {
    expectNear(history.at(stamp).base_in_odom, integrate(twist, stamp));
    EXPECT_NEAR(history.at(stamp).messages, stamp / kPeriod, 1e-9);
  }
}

TEST(OdometryHistory, IsContinuousAcrossMessages) {
  OdometryHistory history;
  Random random(1);
  for (int i = 0; i <= 20; ++i) {
    history.add(twistAt(i * kPeriod, {random.uniform(-3, 3), 0.0, random.uniform(-2, 2)}));
  }
  for (int i = 1; i < 20; ++i) {
    expectNear(history.at(i * kPeriod - 1e-9).base_in_odom,
               history.at(i * kPeriod + 1e-9).base_in_odom, 1e-7);
  }
}

TEST(OdometryHistory, CarriesTheLastTwistOnForALimitedTime) {
  const OdometryHistory history = driven({2.0, 0.0, 0.0}, 50);
  const double limit = OdometryParameters{}.max_odometry_extrapolation;
  EXPECT_NEAR(history.at(1.0 + limit / 2).base_in_odom.x, 2.0 + 2.0 * limit / 2, 1e-9);
  EXPECT_NEAR(history.at(1.0 + limit).base_in_odom.x, 2.0 + 2.0 * limit, 1e-9);
  EXPECT_NEAR(history.at(1e9).base_in_odom.x, 2.0 + 2.0 * limit, 1e-9);
  EXPECT_NEAR(history.at(kInf).base_in_odom.x, 2.0 + 2.0 * limit, 1e-9);
}

TEST(OdometryHistory, GivesTheOldestItKnowsForEarlierTimes) {
  OdometryHistory history = driven({1.0, 0.0, 0.0}, 5, 100.0);
  expectSame(history.at(99.0), OdometryState{});
  expectSame(history.at(-kInf), OdometryState{});
  // Seconds ago is remembered, a minute ago is not: a run of hours takes no more memory.
  history = driven({1.0, 0.0, 0.0}, 3000);
  EXPECT_NEAR(history.at(55.0).base_in_odom.x, 55.0, 1e-6);
  EXPECT_GT(history.at(0.0).base_in_odom.x, 45.0);
}

TEST(OdometryHistory, TakesATimeThatIsNoNumberForTheNewest) {
  const OdometryHistory history = driven({1.0, 0.0, 0.0}, 50);
  expectSame(history.at(kNan), history.at(1.0));
}

TEST(OdometryHistory, CountsReverseAsDistanceAndBothTurnsAsRotation) {
  OdometryHistory history;
  history.add(twistAt(0.0, {}));
  history.add(twistAt(1.0, {1.0, 0.0, 0.5}));
  history.add(twistAt(2.0, {-1.0, 0.0, -0.5}));
  const Motion motion = motionOver(history, 0.0, 2.0);
  EXPECT_NEAR(motion.delta.yaw, 0.0, 1e-12);
  EXPECT_NEAR(motion.distance, 2.0, 1e-12);
  EXPECT_NEAR(motion.rotation, 1.0, 1e-12);
  EXPECT_NEAR(motion.messages, 2.0, 1e-12);
}

TEST(OdometryHistory, CountsOnlyTheTimeSpentMoving) {
  OdometryHistory history;
  history.add(twistAt(0.0, {}));
  history.add(twistAt(0.5, {1.0, 0.0, 0.0}));
  history.add(twistAt(1.0, {1e-4, 0.0, -1e-4}));
  history.add(twistAt(1.5, {0.0, 0.0, 0.3}));
  EXPECT_NEAR(motionOver(history, 0.0, 1.5).seconds, 1.0, 1e-12);
}

TEST(OdometryHistory, SeesMotionFromTheEarlierPosesFrame) {
  OdometryHistory history;
  history.add(twistAt(0.0, {}));
  history.add(twistAt(1.0, {0.0, 0.0, kPi / 2}));
  history.add(twistAt(2.0, {1.0, 0.0, 0.0}));
  expectNear(motionOver(history, 1.0, 2.0).delta, {1.0, 0.0, 0.0});
  expectNear(motionOver(history, 0.0, 2.0).delta, {0.0, 1.0, kPi / 2});
}

TEST(OdometryHistory, MotionBackInTimeIsTheInverseAndHasNoLength) {
  const OdometryHistory history = driven({2.0, 0.0, 1.0}, 50);
  const Motion forward = motionOver(history, 0.4, 0.8);
  const Motion backward = motionOver(history, 0.8, 0.4);
  expectNear(compose(forward.delta, backward.delta), {});
  EXPECT_EQ(backward.distance, 0.0);
  EXPECT_EQ(backward.rotation, 0.0);
  EXPECT_EQ(backward.seconds, 0.0);
  EXPECT_EQ(backward.messages, 0.0);
}

TEST(OdometryHistory, BelievesATwistOverAGapOnlyForTheLimit) {
  OdometryHistory history;
  history.add(twistAt(0.0, {2.0, 0.0, 0.0}));
  EXPECT_EQ(history.add(twistAt(10.0, {2.0, 0.0, 0.0})), OdometryOutcome::kGap);
  EXPECT_NEAR(history.at(10.0).base_in_odom.x, 2.0 * OdometryParameters{}.max_odometry_gap, 1e-9);
  // The car itself is as fast as it says.
  EXPECT_EQ(history.newestTwist().vx, 2.0);
  EXPECT_NEAR(history.at(10.1).base_in_odom.x - history.at(10.0).base_in_odom.x, 0.2, 1e-9);
}

TEST(OdometryHistory, DropsBadMessagesAndStaysAsItWas) {
  OdometryHistory history = driven({2.0, 0.0, 0.3}, 50);
  const OdometryState before = history.at(1.1);
  const struct {
    OdometrySample sample;
    OdometryOutcome outcome;
  } bad[] = {{twistAt(1.0, {9.0, 0.0, 0.0}), OdometryOutcome::kRepeatedStamp},
             {twistAt(0.99, {9.0, 0.0, 0.0}), OdometryOutcome::kOutOfOrder},
             {twistAt(0.01, {9.0, 0.0, 0.0}), OdometryOutcome::kOutOfOrder},
             {twistAt(kNan, {}), OdometryOutcome::kNotFinite},
             {twistAt(kInf, {}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {kNan, 0.0, 0.0}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {0.0, kInf, 0.0}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {0.0, 0.0, -kInf}), OdometryOutcome::kNotFinite},
             {twistAt(1.02, {1e200, 0.0, 0.0}), OdometryOutcome::kImplausible},
             {twistAt(1.02, {0.0, 0.0, -1e4}), OdometryOutcome::kImplausible}};
  for (const auto& [sample, outcome] : bad) {
    EXPECT_EQ(history.add(sample), outcome) << describe(outcome);
    expectSame(history.at(1.1), before);
    EXPECT_EQ(history.newestStamp(), 1.0);
  }
  EXPECT_EQ(history.add(twistAt(1.02, {2.0, 0.0, 0.3})), OdometryOutcome::kUsed);
}

TEST(OdometryHistory, GoesOnSummingWhenTheClockJumpsBack) {
  OdometryHistory history = driven({1.0, 0.0, 0.2}, 500, 100.0);
  const OdometryState before = history.at(110.0);
  EXPECT_EQ(history.add(twistAt(100.0, {1.0, 0.0, 0.2})), OdometryOutcome::kTimeJumpedBack);
  EXPECT_EQ(history.newestStamp(), 100.0);
  expectSame(history.at(100.0), before);
  history.add(twistAt(100.5, {1.0, 0.0, 0.2}));
  expectNear(motionBetween(before, history.at(100.5)).delta, integrate({1.0, 0.0, 0.2}, 0.5));
}

TEST(OdometryHistory, EveryRoundOfALoopingBagIsAlike) {
  OdometryHistory history;
  Pose2 first_round;
  for (int round = 0; round < 3; ++round) {
    OdometryState start;
    for (int i = 0; i <= 200; ++i) {
      const OdometryOutcome outcome =
          history.add(twistAt(50.0 + i * kPeriod, {2.0, 0.0, std::sin(0.1 * i)}));
      EXPECT_EQ(outcome,
                i == 0 && round > 0 ? OdometryOutcome::kTimeJumpedBack : OdometryOutcome::kUsed);
      if (i == 0) start = history.at(50.0);
    }
    const Pose2 moved = motionBetween(start, history.at(54.0)).delta;
    if (round == 0) first_round = moved;
    expectNear(moved, first_round);
  }
}

TEST(OdometryHistory, StartingAgainForgetsMessagesButKeepsTheSums) {
  OdometryHistory history = driven({1.0, 0.0, 0.0}, 50, 100.0);
  history.startAgain();
  EXPECT_TRUE(history.empty());
  EXPECT_NEAR(history.at(5.0).base_in_odom.x, 1.0, 1e-9);
  history.startAgain();
  EXPECT_EQ(history.add(twistAt(5.0, {1.0, 0.0, 0.0})), OdometryOutcome::kUsed);
  history.add(twistAt(5.5, {1.0, 0.0, 0.0}));
  EXPECT_NEAR(history.at(5.5).base_in_odom.x, 1.5, 1e-9);
}

TEST(OdometryOutcome, EachHasItsOwnWords) {
  EXPECT_NE(describe(OdometryOutcome::kImplausible), describe(OdometryOutcome::kNotFinite));
  EXPECT_NE(describe(OdometryOutcome::kRepeatedStamp), describe(OdometryOutcome::kOutOfOrder));
  EXPECT_NE(describe(OdometryOutcome::kGap), describe(OdometryOutcome::kTimeJumpedBack));
}

TEST(OdometryParameters, RefuseWhatCannotBe) {
  for (const double bad : {-0.1, kNan, kInf}) {
    OdometryParameters gap, extrapolation, jump;
    gap.max_odometry_gap = bad;
    extrapolation.max_odometry_extrapolation = bad;
    jump.clock_jump = bad;
    for (const OdometryParameters& parameters : {gap, extrapolation, jump}) {
      EXPECT_THROW(validate(parameters), ParameterError);
      EXPECT_THROW(OdometryHistory{parameters}, ParameterError);
    }
  }
  OdometryParameters none;
  none.max_odometry_extrapolation = 0.0;
  EXPECT_NO_THROW(validate(none));
  none.max_odometry_gap = 0.0;
  EXPECT_THROW(validate(none), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl
