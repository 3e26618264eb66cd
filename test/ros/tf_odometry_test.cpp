#include "ros/localization/tf_odometry.h"

#include <gtest/gtest.h>

#include <limits>

#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {
namespace {

tf2_msgs::TFMessage transform(const std::string& parent, const std::string& child, double stamp,
                              const Pose2& child_in_parent) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.stamp = ros::Time(stamp);
  message.transforms[0].header.frame_id = parent;
  message.transforms[0].child_frame_id = child;
  message.transforms[0].transform = toTransform(child_in_parent);
  return message;
}

class TfOdometryTest : public testing::Test {
 protected:
  nav_msgs::OdometryConstPtr move(double stamp, double x) {
    return odometry_.add(transform("odom", "base_link", stamp, {x, 2.0, 0.5}), false);
  }
  TfOdometry odometry_{"odom", "base_link", 1.0};
};

TEST_F(TfOdometryTest, GivesThePoseOfTheBaseWithItsStampAndFrames) {
  const auto odometry = move(12.5, 1.0);
  ASSERT_TRUE(odometry);
  EXPECT_EQ(odometry->header.stamp, ros::Time(12.5));
  EXPECT_EQ(odometry->header.frame_id, "odom");
  EXPECT_EQ(odometry->child_frame_id, "base_link");
  const Pose2 pose = toPose2(odometry->pose.pose);
  EXPECT_DOUBLE_EQ(pose.x, 1.0);
  EXPECT_DOUBLE_EQ(pose.y, 2.0);
  EXPECT_NEAR(pose.yaw, 0.5, 1e-12);
}

TEST_F(TfOdometryTest, SaysNothingTwice) {
  EXPECT_TRUE(move(12.5, 1.0));
  EXPECT_FALSE(move(12.5, 1.0));
  EXPECT_FALSE(odometry_.add(transform("base_link", "wheel", 12.6, {}), false));
  EXPECT_FALSE(odometry_.add(transform("map", "odom", 12.6, {}), false));
  EXPECT_FALSE(move(12.4, 0.9)) << "late, but not a time jump";
  EXPECT_TRUE(move(12.6, 1.1));
}

TEST_F(TfOdometryTest, FollowsAWayOverOtherFrames) {
  EXPECT_FALSE(
      odometry_.add(transform("/base_footprint", "/base_link", 0.0, {0.1, 0.0, 0.0}), true));
  const auto odometry =
      odometry_.add(transform("/odom", "/base_footprint", 5.0, {1.0, 2.0, kPi / 2.0}), false);
  ASSERT_TRUE(odometry);
  EXPECT_EQ(odometry->header.stamp, ros::Time(5.0));
  const Pose2 pose = toPose2(odometry->pose.pose);
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 2.1, 1e-12);
}

TEST_F(TfOdometryTest, StaticTransformsAloneAreNoOdometry) {
  EXPECT_FALSE(odometry_.add(transform("odom", "base_link", 3.0, {}), true));
}

TEST_F(TfOdometryTest, StartsAgainWhereTheClockJumpsBack) {
  odometry_.add(transform("base_footprint", "base_link", 0.0, {0.1, 0.0, 0.0}), true);
  const auto at = [&](double stamp, double x) {
    return odometry_.add(transform("odom", "base_footprint", stamp, {x, 0.0, 0.0}), false);
  };
  EXPECT_TRUE(at(100.0, 5.0));
  EXPECT_FALSE(at(95.9, 0.9)) << "one stamp alone is no jump";
  const auto again = at(96.0, 1.0);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->header.stamp, ros::Time(96.0));
  EXPECT_NEAR(toPose2(again->pose.pose).x, 1.1, 1e-12) << "with the static transform";
  EXPECT_TRUE(at(96.1, 1.2));
}

TEST_F(TfOdometryTest, OneWrongStampIsDropped) {
  double stamp = 100.0;
  EXPECT_TRUE(move(stamp, 1.0));
  for (const double wrong : {-30.0, -1.5, 1.5, 30.0}) {
    EXPECT_FALSE(move(stamp + wrong, 1.0));
    const auto next = move(stamp += 0.02, 1.0);
    ASSERT_TRUE(next) << wrong;
    EXPECT_NEAR(next->header.stamp.toSec(), stamp, 1e-6);
  }
}

TEST_F(TfOdometryTest, AnOldTransformOfAnotherPartIsNoJumpOfTheClock) {
  EXPECT_TRUE(move(100.0, 1.0));
  EXPECT_FALSE(odometry_.add(transform("base_link", "wheel", 90.5, {}), false));
  EXPECT_TRUE(move(100.1, 1.1));
  EXPECT_FALSE(move(99.5, 1.0));
}

TEST_F(TfOdometryTest, LeavesOutWhatIsNoTransform) {
  EXPECT_FALSE(move(1.0, std::numeric_limits<double>::quiet_NaN()));
  tf2_msgs::TFMessage broken = transform("odom", "base_link", 1.0, {});
  broken.transforms[0].transform.rotation.w = 0.0;
  EXPECT_FALSE(odometry_.add(broken, false));
  EXPECT_FALSE(odometry_.add(transform("", "base_link", 1.0, {}), false));
  EXPECT_TRUE(move(2.0, 1.0));
}

}  // namespace
}  // namespace racecar_mcl
