#include "ros/conversions/message_conversions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace racecar_mcl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfF = std::numeric_limits<float>::infinity();

geometry_msgs::Quaternion quaternion(double x, double y, double z, double w) {
  geometry_msgs::Quaternion q;
  q.x = x;
  q.y = y;
  q.z = z;
  q.w = w;
  return q;
}

/// Fixed-axis roll, pitch, yaw, as in tf.
geometry_msgs::Quaternion fromRollPitchYaw(double roll, double pitch, double yaw) {
  const double cr = std::cos(roll / 2), sr = std::sin(roll / 2);
  const double cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
  const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2);
  return quaternion(sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                    cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy);
}

geometry_msgs::Transform mountedAt(double x, double y, const geometry_msgs::Quaternion& rotation) {
  geometry_msgs::Transform transform;
  transform.translation.x = x;
  transform.translation.y = y;
  transform.translation.z = 0.12;
  transform.rotation = rotation;
  return transform;
}

/// Five beams, 0.5 rad apart, symmetric about the x axis.
sensor_msgs::LaserScan fiveBeams() {
  sensor_msgs::LaserScan scan;
  scan.header.stamp = ros::Time(1600000000, 250000000);
  scan.angle_min = -1.0f;
  scan.angle_max = 1.0f;
  scan.angle_increment = 0.5f;
  scan.time_increment = 0.001f;
  scan.range_min = 0.1f;
  scan.range_max = 10.0f;
  scan.ranges = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f};
  return scan;
}

std::string refusalOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const MessageError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no MessageError was thrown";
  return {};
}

TEST(Frames, LoseTheirLeadingSlashes) {
  EXPECT_EQ(stripLeadingSlash("/base_link"), "base_link");
  EXPECT_EQ(stripLeadingSlash("base_link"), "base_link");
  EXPECT_EQ(stripLeadingSlash("//car/laser"), "car/laser");
  EXPECT_EQ(stripLeadingSlash("/"), "");
  EXPECT_EQ(stripLeadingSlash(""), "");
}

TEST(Yaw, ComesBackFromItsQuaternion) {
  for (double yaw = -3.1; yaw <= 3.15; yaw += 0.1) {
    EXPECT_NEAR(yawOf(quaternionOf(yaw)), yaw, 1e-12);
  }
  EXPECT_NEAR(std::abs(yawOf(quaternionOf(kPi))), kPi, 1e-12);
}

TEST(Yaw, NeedsNoUnitLengthAndNoSign) {
  EXPECT_NEAR(yawOf(quaternion(0.0, 0.0, 5.0 * std::sin(0.3), 5.0 * std::cos(0.3))), 0.6, 1e-12);
  EXPECT_NEAR(yawOf(quaternion(0.0, 0.0, -std::sin(0.3), -std::cos(0.3))), 0.6, 1e-12);
}

TEST(Yaw, IsTheHeadingOfATiltedBody) {
  EXPECT_NEAR(yawOf(fromRollPitchYaw(0.1, 0.0, 1.2)), 1.2, 1e-12);
  EXPECT_NEAR(yawOf(fromRollPitchYaw(0.1, -0.2, 1.2)), 1.2, 1e-12);
}

TEST(Yaw, RefusesAQuaternionThatIsNoOrientation) {
  for (const geometry_msgs::Quaternion& bad :
       {quaternion(0.0, 0.0, 0.0, 0.0), quaternion(kNan, 0.0, 0.0, 1.0),
        quaternion(0.0, 0.0, kInf, 1.0), quaternion(0.0, 0.0, 1e-12, 1e-12),
        quaternion(1e200, 0.0, 0.0, 1e200)}) {
    EXPECT_NE(refusalOf([&] { yawOf(bad); }).find("quaternion"), std::string::npos);
  }
}

TEST(Pose, ComesBackFromItsMessage) {
  for (const Pose2& pose : {Pose2{}, Pose2{1.0, -2.0, 3.0}, Pose2{-1e5, 1e-5, -0.001}}) {
    const Pose2 back = toPose2(toMessage(pose));
    EXPECT_EQ(back.x, pose.x);
    EXPECT_EQ(back.y, pose.y);
    EXPECT_NEAR(back.yaw, pose.yaw, 1e-12);
    const geometry_msgs::Transform transform = toTransform(pose);
    EXPECT_EQ(transform.translation.x, pose.x);
    EXPECT_EQ(transform.translation.y, pose.y);
    EXPECT_NEAR(yawOf(transform.rotation), pose.yaw, 1e-12);
  }
}

TEST(Pose, RefusesWhatIsNotFinite) {
  for (const double bad : {kNan, kInf, -kInf, 1e308, -1.1e7}) {
    geometry_msgs::Pose pose = toMessage(Pose2{1.0, 2.0, 0.5});
    pose.position.y = bad;
    EXPECT_THROW(toPose2(pose), MessageError);
    pose = toMessage(Pose2{1.0, 2.0, 0.5});
    pose.orientation.w = bad;
    if (std::abs(bad) > 1e8 || std::isnan(bad)) {
      EXPECT_THROW(toPose2(pose), MessageError);
    }
  }
  EXPECT_THROW(toPose2(geometry_msgs::Pose()), MessageError);  // a quaternion of zeros
}

TEST(PoseEstimate, ComesBackFromItsMessage) {
  PoseEstimate estimate{{1.0, 2.0, 0.5}, {}};
  estimate.covariance << 1.0, 0.2, 0.3, 0.2, 4.0, 0.5, 0.3, 0.5, 9.0;
  const PoseEstimate back = toPoseEstimate(toMessage(estimate));
  EXPECT_EQ(back.base_in_map.x, 1.0);
  EXPECT_EQ(back.base_in_map.y, 2.0);
  EXPECT_NEAR(back.base_in_map.yaw, 0.5, 1e-12);
  EXPECT_TRUE(back.covariance == estimate.covariance);
}

TEST(PoseEstimate, FillsTheCellsOfXYAndYawOnly) {
  PoseEstimate estimate;
  estimate.covariance << 1.0, 2.0, 3.0, 2.0, 4.0, 5.0, 3.0, 5.0, 6.0;
  const geometry_msgs::PoseWithCovariance message = toMessage(estimate);
  // Rows and columns: x, y, z, roll, pitch, yaw.
  std::vector<double> expected(36, 0.0);
  expected[0] = 1.0;
  expected[1] = expected[6] = 2.0;
  expected[5] = expected[30] = 3.0;
  expected[7] = 4.0;
  expected[11] = expected[31] = 5.0;
  expected[35] = 6.0;
  EXPECT_EQ(std::vector<double>(message.covariance.begin(), message.covariance.end()), expected);
}

TEST(PoseEstimate, RefusesACovarianceThatIsNotFiniteWhereItIsRead) {
  geometry_msgs::PoseWithCovariance message = toMessage(PoseEstimate{});
  message.covariance[14] = kNan;  // z, which is not used
  EXPECT_NO_THROW(toPoseEstimate(message));
  for (const std::size_t cell : {0u, 1u, 5u, 6u, 7u, 11u, 30u, 31u, 35u}) {
    message = toMessage(PoseEstimate{});
    message.covariance[cell] = kInf;
    EXPECT_THROW(toPoseEstimate(message), MessageError) << "cell " << cell;
  }
}

TEST(Odometry, CarriesStampTwistAndPose) {
  nav_msgs::Odometry message;
  message.header.stamp = ros::Time(1600000000, 123456789);
  message.twist.twist.linear.x = 3.0;
  message.twist.twist.linear.y = -0.2;
  message.twist.twist.angular.z = 1.5;
  message.pose.pose = toMessage(Pose2{4.0, 5.0, 0.6});
  const OdometrySample sample = toOdometrySample(message);
  EXPECT_NEAR(sample.stamp, 1600000000.123456789, 1e-6);
  EXPECT_EQ(sample.twist.vx, 3.0);
  EXPECT_EQ(sample.twist.vy, -0.2);
  EXPECT_EQ(sample.twist.wz, 1.5);
  EXPECT_EQ(sample.base_in_odom.x, 4.0);
  EXPECT_EQ(sample.base_in_odom.y, 5.0);
  EXPECT_NEAR(sample.base_in_odom.yaw, 0.6, 1e-12);
}

TEST(Odometry, LeavesBadNumbersForTheLocalizerToCount) {
  nav_msgs::Odometry message;  // many drivers leave the quaternion zero
  message.twist.twist.linear.x = 3.0;
  EXPECT_FALSE(isFinite(toOdometrySample(message).base_in_odom));
  EXPECT_TRUE(isFinite(toOdometrySample(message).twist));
  message.twist.twist.angular.z = kNan;
  EXPECT_FALSE(isFinite(toOdometrySample(message).twist));
}

TEST(LidarExtrinsics, TakesAnUprightLidarAsItIs) {
  const LidarExtrinsics extrinsics = toLidarExtrinsics(mountedAt(0.27, 0.01, quaternionOf(0.3)));
  EXPECT_FALSE(extrinsics.upside_down);
  EXPECT_EQ(extrinsics.laser_in_base.x, 0.27);
  EXPECT_EQ(extrinsics.laser_in_base.y, 0.01);
  EXPECT_NEAR(extrinsics.laser_in_base.yaw, 0.3, 1e-12);
}

TEST(LidarExtrinsics, AllowsALittleTiltAndNoMore) {
  EXPECT_NEAR(
      toLidarExtrinsics(mountedAt(0.27, 0.0, fromRollPitchYaw(0.1, 0.1, 1.0))).laser_in_base.yaw,
      1.0, 1e-12);
  for (const auto& [roll, pitch] : {std::pair{0.3, 0.0}, std::pair{0.0, -0.5},
                                    std::pair{kPi / 2, 0.0}, std::pair{kPi - 0.3, 0.0}}) {
    EXPECT_NE(refusalOf([&, r = roll, p = pitch] {
                toLidarExtrinsics(mountedAt(0.0, 0.0, fromRollPitchYaw(r, p, 0.4)));
              }).find("tilted"),
              std::string::npos);
  }
}

TEST(LidarExtrinsics, RefusesWhatIsNotFinite) {
  EXPECT_THROW(toLidarExtrinsics(mountedAt(kNan, 0.0, quaternionOf(0.0))), MessageError);
  for (const double far : {1e308, -1e308, 1e7, 101.0}) {
    const std::string refusal =
        refusalOf([&] { toLidarExtrinsics(mountedAt(0.3, far, quaternionOf(0.0))); });
    EXPECT_NE(refusal.find("the lidar is at (0.3, "), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("within 100 m"), std::string::npos) << refusal;
  }
  EXPECT_THROW(toLidarExtrinsics(mountedAt(0.0, -kInf, quaternionOf(0.0))), MessageError);
  EXPECT_THROW(toLidarExtrinsics(mountedAt(0.0, 0.0, quaternion(0.0, 0.0, 0.0, 0.0))),
               MessageError);
  EXPECT_THROW(toLidarExtrinsics(mountedAt(0.0, 0.0, quaternion(0.0, kNan, 0.0, 1.0))),
               MessageError);
}

/// The end point of beam `i` in the car's frame.
Eigen::Vector2d endInBase(const Scan& scan, Eigen::Index i) {
  const double angle = scan.laser_in_base.yaw + static_cast<double>(scan.bearings[i]);
  const double range = static_cast<double>(scan.ranges[i]);
  return {scan.laser_in_base.x + range * std::cos(angle),
          scan.laser_in_base.y + range * std::sin(angle)};
}

TEST(LidarExtrinsics, ALidarOnItsHeadSeesLeftWhereItSaysRight) {
  // Rolled by pi and rotated left by 90 degrees, 0.2 m ahead. A beam at -1 rad with 1 m has the
  // direction (cos 1, -sin 1, 0), after the roll (cos 1, sin 1, 0), after the yaw
  // (-sin 1, cos 1, 0).
  const LidarExtrinsics extrinsics =
      toLidarExtrinsics(mountedAt(0.2, 0.0, fromRollPitchYaw(kPi, 0.0, kPi / 2)));
  EXPECT_TRUE(extrinsics.upside_down);
  EXPECT_NEAR(extrinsics.laser_in_base.yaw, kPi / 2, 1e-12);
  const Scan scan = toScan(fiveBeams(), extrinsics);
  const Eigen::Vector2d end = endInBase(scan, 0);
  EXPECT_NEAR(end.x(), 0.2 - std::sin(1.0), 1e-6);
  EXPECT_NEAR(end.y(), std::cos(1.0), 1e-6);
  // Beams keep their order and their times.
  EXPECT_NEAR(scan.bearings[0], 1.0, 1e-6);
  EXPECT_NEAR(scan.bearings[4], -1.0, 1e-6);
  EXPECT_NEAR(scan.seconds_after_stamp[4], 0.004, 1e-6);
}

TEST(LidarExtrinsics, RolledOrPitchedOverIsTheSameHeadDown) {
  // Pitched by pi, the lidar faces backwards: (cos b, sin b) becomes (-cos b, sin b).
  const LidarExtrinsics extrinsics =
      toLidarExtrinsics(mountedAt(0.0, 0.0, fromRollPitchYaw(0.0, kPi, 0.0)));
  EXPECT_TRUE(extrinsics.upside_down);
  const Scan scan = toScan(fiveBeams(), extrinsics);
  for (Eigen::Index i = 0; i < 5; ++i) {
    const double bearing = -1.0 + 0.5 * static_cast<double>(i);
    const double range = 1.0 + static_cast<double>(i);
    EXPECT_NEAR(endInBase(scan, i).x(), -range * std::cos(bearing), 1e-5);
    EXPECT_NEAR(endInBase(scan, i).y(), range * std::sin(bearing), 1e-5);
  }
}

TEST(LaserScan, KeepsValidBeamsWithTheirBearingsAndTimes) {
  const Scan scan = toScan(fiveBeams(), {{0.27, 0.0, 0.1}, false});
  EXPECT_NEAR(scan.stamp, 1600000000.25, 1e-6);
  EXPECT_EQ(scan.laser_in_base.x, 0.27);
  ASSERT_EQ(scan.size(), 5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_NEAR(scan.bearings[i], -1.0 + 0.5 * static_cast<double>(i), 1e-6);
    EXPECT_EQ(scan.ranges[i], 1.0f + static_cast<float>(i));
    EXPECT_NEAR(scan.seconds_after_stamp[i], 0.001 * static_cast<double>(i), 1e-8);
  }
}

TEST(LaserScan, DropsWhatIsNoRangeAndKeepsTheOthersInPlace) {
  sensor_msgs::LaserScan message = fiveBeams();
  message.ranges = {kNanF, 2.0f, -kInfF, 0.05f, 5.0f};
  const Scan scan = toScan(message, {});
  ASSERT_EQ(scan.size(), 2);
  ASSERT_EQ(scan.ranges.size(), 2);
  ASSERT_EQ(scan.seconds_after_stamp.size(), 2);
  EXPECT_EQ(scan.ranges[0], 2.0f);
  EXPECT_NEAR(scan.bearings[0], -0.5, 1e-6);
  EXPECT_NEAR(scan.seconds_after_stamp[0], 0.001, 1e-8);
  EXPECT_EQ(scan.ranges[1], 5.0f);
  EXPECT_NEAR(scan.bearings[1], 1.0, 1e-6);
  message.ranges = {-1.0f, 0.0f, -0.0f, kNanF, -kInfF};
  message.range_min = 0.0f;
  EXPECT_EQ(toScan(message, {}).size(), 0);
}

TEST(LaserScan, NothingWithinRangeIsEvidence) {
  sensor_msgs::LaserScan message = fiveBeams();
  message.ranges = {kInfF, 10.5f, 65.533f, 10.0f, 9.9f};
  const Scan scan = toScan(message, {});
  ASSERT_EQ(scan.size(), 5);
  EXPECT_EQ(scan.ranges[0], kInfF);
  EXPECT_EQ(scan.ranges[1], kInfF);
  EXPECT_EQ(scan.ranges[2], kInfF);
  EXPECT_EQ(scan.ranges[3], kInfF) << "at range_max, as in amcl";
  EXPECT_EQ(scan.ranges[4], 9.9f);
}

TEST(LaserScan, MayRunClockwise) {
  sensor_msgs::LaserScan message = fiveBeams();
  message.angle_min = 1.0f;
  message.angle_max = -1.0f;
  message.angle_increment = -0.5f;
  const Scan scan = toScan(message, {});
  ASSERT_EQ(scan.size(), 5);
  EXPECT_NEAR(scan.bearings[0], 1.0, 1e-6);
  EXPECT_NEAR(scan.bearings[4], -1.0, 1e-6);
}

TEST(LaserScan, BringsBearingsOfAFullTurnIntoOne) {
  sensor_msgs::LaserScan message = fiveBeams();
  message.angle_min = 0.0f;
  message.angle_max = static_cast<float>(2 * kPi);
  message.angle_increment = static_cast<float>(kPi / 2);
  const Scan scan = toScan(message, {});
  EXPECT_NEAR(scan.bearings[1], kPi / 2, 1e-5);
  EXPECT_NEAR(scan.bearings[3], -kPi / 2, 1e-5);
  EXPECT_NEAR(scan.bearings[4], 0.0, 1e-5);
}

TEST(LaserScan, RefusesWhatCannotBeAndNamesTheField) {
  const struct {
    const char* field;
    std::function<void(sensor_msgs::LaserScan*)> spoil;
  } bad[] = {{"empty", [](auto* scan) { scan->ranges.clear(); }},
             {"angle_min", [](auto* scan) { scan->angle_min = kNanF; }},
             {"angle_min", [](auto* scan) { scan->angle_min = -kInfF; }},
             {"angle_min", [](auto* scan) { scan->angle_min = 1e30f; }},
             {"angle_min", [](auto* scan) { scan->angle_min = -14.0f; }},
             {"angle_increment", [](auto* scan) { scan->angle_increment = 0.0f; }},
             {"angle_increment", [](auto* scan) { scan->angle_increment = kNanF; }},
             {"angle_increment", [](auto* scan) { scan->angle_increment = kInfF; }},
             {"angle_increment", [](auto* scan) { scan->angle_increment = -0.5f; }},
             {"angle_increment", [](auto* scan) { scan->angle_increment = 3.0f; }},
             {"time_increment", [](auto* scan) { scan->time_increment = -0.001f; }},
             {"time_increment", [](auto* scan) { scan->time_increment = kNanF; }},
             {"time_increment", [](auto* scan) { scan->time_increment = 1.0f; }},
             {"range_max", [](auto* scan) { scan->range_max = scan->range_min; }},
             {"range_max", [](auto* scan) { scan->range_max = kNanF; }},
             {"range_min", [](auto* scan) { scan->range_min = kNanF; }}};
  for (const auto& [field, spoil] : bad) {
    sensor_msgs::LaserScan message = fiveBeams();
    spoil(&message);
    const std::string refusal = refusalOf([&] { toScan(message, {}); });
    EXPECT_NE(refusal.find(field), std::string::npos) << refusal;
  }
}

TEST(LaserScan, WithoutDeskewTheTimeIncrementDoesNotMatter) {
  for (const float nonsense : {153333.0f, -2e-5f, kNanF, kInfF}) {
    sensor_msgs::LaserScan message = fiveBeams();
    message.time_increment = nonsense;
    EXPECT_NE(refusalOf([&] { toScan(message, {}); }).find("or deskew"), std::string::npos);
    const Scan scan = toScan(message, {}, false);
    EXPECT_EQ(scan.size(), 5);
    EXPECT_TRUE((scan.seconds_after_stamp == 0.0f).all());
  }
}

TEST(LaserScan, HoldsOnlyNumbersWhateverTheRangesAre) {
  sensor_msgs::LaserScan message = fiveBeams();
  message.ranges.clear();
  const float odd[] = {kNanF, kInfF, -kInfF, 0.0f, -0.0f, -5.0f, 1e-40f, 3e38f, 1.0f, 10.0f};
  for (int i = 0; i < 1080; ++i) message.ranges.push_back(odd[(i * 7) % 10]);
  message.angle_increment = static_cast<float>(1.5 * kPi / 1080);
  message.time_increment = 1.7e-5f;
  const Scan scan = toScan(message, {});
  EXPECT_EQ(scan.size(), 4 * 108);
  EXPECT_TRUE(scan.bearings.isFinite().all());
  EXPECT_TRUE(scan.seconds_after_stamp.isFinite().all());
  EXPECT_TRUE((scan.ranges >= message.range_min).all());
}

}  // namespace
}  // namespace racecar_mcl
