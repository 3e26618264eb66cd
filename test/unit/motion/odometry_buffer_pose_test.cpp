// Motion from poses instead of twists.
#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/motion/odometry_buffer.h"
#include "support/expect_pose.h"

namespace racecar_mcl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod = 0.02;  // s, a car's odometry at 50 Hz

OdometrySample twistAt(double stamp, const Twist2& twist) { return {stamp, twist, {}}; }
OdometrySample poseAt(double stamp, const Pose2& pose) { return {stamp, {}, pose}; }

OdometryParameters fromPose() {
  OdometryParameters parameters;
  parameters.motion_from = MotionFrom::kPose;
  return parameters;
}

TEST(OdometryBuffer, PosesAndTwistsOfOneDriveAgree) {
  OdometryBuffer from_twists;
  OdometryBuffer from_poses(fromPose());
  Random random(4);
  Pose2 base_in_odom{30.0, -12.0, 3.0};
  double stamp = 5.0;
  for (int i = 0; i < 300; ++i) {
    const Twist2 twist{random.uniform(-2, 7), random.uniform(-0.3, 0.3), random.uniform(-3, 3)};
    const double seconds = random.uniform(0.005, 0.05);
    if (i > 0) base_in_odom = compose(base_in_odom, integrate(twist, seconds));
    stamp += seconds;
    from_twists.add(twistAt(stamp, twist));
    from_poses.add(poseAt(stamp, base_in_odom));
  }
  EXPECT_NEAR(from_poses.newestTwist().vx, from_twists.newestTwist().vx, 1e-6);
  for (double t = stamp - 7.0; t < stamp + 0.4; t += 0.0731) {
    expectNear(from_poses.at(t).base_in_odom, from_twists.at(t).base_in_odom, 1e-6);
    EXPECT_NEAR(from_poses.at(t).distance, from_twists.at(t).distance, 1e-6);
    EXPECT_NEAR(from_poses.at(t).rotation, from_twists.at(t).rotation, 1e-6);
    EXPECT_NEAR(from_poses.at(t).messages, from_twists.at(t).messages, 1e-6);
  }
}

TEST(OdometryBuffer, NeedsNoTwistsWithPoses) {
  OdometryBuffer history(fromPose());
  const Twist2 nothing{kNan, kNan, kNan};
  EXPECT_EQ(history.add({0.0, nothing, {5.0, 0.0, 0.0}}), OdometryOutcome::kUsed);
  EXPECT_EQ(history.at(0.2).base_in_odom.x, 0.0);
  EXPECT_EQ(history.newestTwist().vx, 0.0);
  EXPECT_EQ(history.add({0.1, nothing, {5.2, 0.0, 0.0}}), OdometryOutcome::kUsed);
  EXPECT_NEAR(history.at(0.1).base_in_odom.x, 0.2, 1e-12);
  EXPECT_NEAR(history.newestTwist().vx, 2.0, 1e-12);
  EXPECT_EQ(history.add(poseAt(0.2, {kNan, 0.0, 0.0})), OdometryOutcome::kNotFinite);
}

TEST(OdometryBuffer, DoesNotFollowAResetOfTheOdometryFrame) {
  OdometryBuffer history(fromPose());
  for (int i = 0; i <= 50; ++i) history.add(poseAt(i * kPeriod, {40.0 + i * 0.04, 7.0, 1.0}));
  const Pose2 before = history.at(1.0).base_in_odom;
  EXPECT_EQ(history.add(poseAt(1.02, {})), OdometryOutcome::kImplausible);
  expectNear(history.at(1.02).base_in_odom, before);
  EXPECT_EQ(history.add(poseAt(1.04, {0.04, 0.0, 0.0})), OdometryOutcome::kUsed);
  expectNear(history.at(1.04).base_in_odom, compose(before, {0.04, 0.0, 0.0}));
  const Pose2 after = history.at(1.04).base_in_odom;
  EXPECT_EQ(history.add(poseAt(1.06, {1e308, -1e308, 0.0})), OdometryOutcome::kNotFinite);
  EXPECT_EQ(history.add(poseAt(1.08, {-1e308, 1e308, 2.0})), OdometryOutcome::kNotFinite);
  expectNear(history.at(1.04).base_in_odom, after);
}

TEST(OdometryBuffer, DoesNotExtrapolateTheJitterOfPosesInQuickSuccession) {
  OdometryBuffer history(fromPose());
  history.add(poseAt(0.0, {}));
  history.add(poseAt(0.1, {0.1, 0.0, 0.0}));
  history.add(poseAt(0.1 + 1e-6, {0.11, 0.0, 0.0}));
  EXPECT_NEAR(history.at(0.1 + 1e-6).base_in_odom.x, 0.11, 1e-9);
  EXPECT_NEAR(history.at(0.3).base_in_odom.x, 0.11 + 0.2 * 1.0, 1e-5);
}

}  // namespace
}  // namespace racecar_mcl
