// Topics and services of the simulator node.
#include <limits>

#include "racecar_mcl/common/errors.h"
#include "support/process.h"
#include "support/simulator_fixture.h"

namespace racecar_mcl {
namespace {

using SimulatorTopicsTest = SimulatorTest;

TEST_F(SimulatorTopicsTest, PublishesWhatACarDoesOnTheWallsClock) {
  startNode();
  ASSERT_TRUE(waitForScans(5));
  const double now = ros::WallTime::now().toSec();
  EXPECT_NEAR(scan_.newest().header.stamp.toSec(), now, 1.0);
  EXPECT_NEAR(odometry_.newest().header.stamp.toSec(), now, 1.0);
  EXPECT_EQ(scan_.newest().header.frame_id, "laser");
  EXPECT_EQ(odometry_.newest().child_frame_id, "base_link");
  EXPECT_EQ(truth_.newest().child_frame_id, "base_link_truth");
  EXPECT_LT(distance(baseInMap(), start_), 1e-6);
  EXPECT_EQ(collisions_.newest().data, 0);
}

TEST_F(SimulatorTopicsTest, IsMovedByPlaceAndNotByInitialPose) {
  ros::Publisher initial_pose =
      handle_.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1, true);
  geometry_msgs::PoseWithCovarianceStamped elsewhere;
  elsewhere.header.frame_id = "map";
  elsewhere.pose.pose = toMessage(Pose2{-5.0, -2.65, 0.0});
  initial_pose.publish(elsewhere);
  startNode();
  initial_pose.publish(elsewhere);
  ASSERT_TRUE(waitForScans(20));
  EXPECT_LT(distance(baseInMap(), start_), 1e-6);

  const Pose2 there{-5.0, -2.5, 3.0};
  const Pose2 odometry_before = toPose2(odometry_.newest().pose.pose);
  places_.publish(poseMessage(there));
  EXPECT_TRUE(waitFor([&] { return distance(baseInMap(), there) < 1e-6; }));
  EXPECT_NEAR(baseInMap().yaw, 3.0, 1e-6);
  EXPECT_LT(distance(toPose2(odometry_.newest().pose.pose), odometry_before), 0.2)
      << "odometry does not measure the displacement";
}

TEST_F(SimulatorTopicsTest, IsNotPlacedWhereItCannotBe) {
  startNode();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  places_.publish(poseMessage({nan, 0.0, 0.0}));
  places_.publish(poseMessage({-7.8, 3000.0, 0.0}));
  places_.publish(poseMessage({-5.0, -2.5, 0.0}, "odom"));
  places_.publish(poseMessage({-7.8, -4.3, 0.0}));
  ASSERT_TRUE(waitForScans(20));
  EXPECT_LT(distance(baseInMap(), start_), 1e-6);
}

TEST_F(SimulatorTopicsTest, SeesWhatIsPutInItsWayUntilItIsCleared) {
  startNode();
  ASSERT_TRUE(waitForScans(2));
  ASSERT_GT(rangeAhead(), 4.0);
  points_.publish(pointMessage(start_.x + 2.0, start_.y));
  // The lidar is 0.27 m ahead of base_link, the disc's radius 0.2 m.
  ASSERT_TRUE(waitFor([&] { return std::abs(rangeAhead() - (2.0 - 0.27 - 0.2)) < 0.02; }))
      << rangeAhead();
  EXPECT_TRUE(waitFor([&] { return obstacles_.newest().markers.size() == 2; }));
  points_.publish(pointMessage(std::numeric_limits<double>::infinity(), 0.0));
  std_srvs::Empty nothing;
  ASSERT_TRUE(ros::service::call(namespace_ + "/simulator/clear_obstacles", nothing));
  EXPECT_TRUE(waitFor([&] { return rangeAhead() > 4.0; }));
  EXPECT_TRUE(waitFor([&] { return obstacles_.newest().markers.size() == 1; }));
}

TEST_F(SimulatorTopicsTest, SeesObstaclesWalkToAndFro) {
  parameters_.setParam("obstacle_walk", 1.0);
  parameters_.setParam("obstacle_speed", 2.0);
  startNode();
  walkers_.publish(poseMessage({start_.x + 2.0, start_.y, 0.0}));
  double nearest = 1e9, furthest = 0.0;
  EXPECT_TRUE(waitFor([&] {
    const double range = rangeAhead();
    if (range < 3.0) {
      nearest = std::min(nearest, range);
      furthest = std::max(furthest, range);
    }
    return furthest - nearest > 0.8;
  })) << nearest
      << " to " << furthest;
  EXPECT_GT(nearest, 1.53 - 0.02);
  const int markers = obstacles_.count();
  EXPECT_TRUE(waitFor([&] { return obstacles_.count() > markers + 3; }))
      << "markers of moving obstacles are updated";
}

TEST_F(SimulatorTopicsTest, ObeysTwistsWhileTheyAreFresh) {
  startNode();
  for (int i = 0; i < 20; ++i) {
    drive(1.0, 0.5);
    ASSERT_TRUE(waitForScans(2));
  }
  EXPECT_NEAR(speed(), 1.0, 1e-6);
  EXPECT_NEAR(truth_.newest().twist.twist.angular.z, 0.5, 1e-3);
  EXPECT_TRUE(waitFor([&] { return speed() == 0.0; })) << "the command has expired";
}

#ifdef RACECAR_MCL_HAS_ACKERMANN
TEST_F(SimulatorTopicsTest, ObeysAckermannCommands) {
  startNode();
  ros::Publisher drives = handle_.advertise<ackermann_msgs::AckermannDriveStamped>("drive", 5);
  EXPECT_TRUE(waitFor([&] {
    ackermann_msgs::AckermannDriveStamped command;
    command.drive.speed = 1.0;
    command.drive.steering_angle = 0.2;
    drives.publish(command);
    // wz = speed tan(steering) / wheelbase
    return std::abs(truth_.newest().twist.twist.angular.z - std::tan(0.2) / 0.325) < 1e-3;
  }));
}
#endif

TEST_F(SimulatorTopicsTest, DropsCommandsThatAreNotFinite) {
  startNode();
  drive(std::numeric_limits<double>::quiet_NaN(), 0.0);
  drive(1.0, std::numeric_limits<double>::infinity());
  ASSERT_TRUE(waitForScans(20));
  EXPECT_TRUE(std::isfinite(baseInMap().x) && std::isfinite(baseInMap().yaw));
  drive(1.0, 0.0);
  EXPECT_TRUE(waitFor([&] { return speed() > 0.9; }));
}

TEST_F(SimulatorTopicsTest, FollowsTheWallOnlyWhileNobodyCommands) {
  parameters_.setParam("driver", std::string("auto"));
  startNode();
  EXPECT_TRUE(waitFor([&] { return speed() > 1.0; }));
  EXPECT_TRUE(waitFor([&] {
    drive(0.0, 0.0);
    return speed() == 0.0;
  }));
  EXPECT_TRUE(waitFor([&] { return speed() > 1.0; }));
}

TEST_F(SimulatorTopicsTest, CountsCollisions) {
  startNode();
  points_.publish(pointMessage(start_.x + 1.0, start_.y));
  EXPECT_TRUE(waitFor([&] {
    drive(1.0, 0.0);
    return collisions_.newest().data == 1;
  }));
}

TEST_F(SimulatorTopicsTest, ChangesItsParametersWhileItRuns) {
  startNode();
  parameters_.setParam("forward_noise", 0.0);
  parameters_.setParam("sideways_noise", 0.0);
  parameters_.setParam("turn_noise", 0.0);
  parameters_.setParam("speed_bias", 0.25);
  EXPECT_TRUE(reload().success);
  EXPECT_TRUE(waitFor([&] { return odometry_.newest().twist.twist.linear.x == 0.25; }));

  parameters_.setParam("glass", 1.0);
  EXPECT_TRUE(reload().success);
  EXPECT_TRUE(waitFor([&] { return std::isinf(rangeAhead()); })) << "all walls are glass";

  parameters_.setParam("obstacles", 3);
  EXPECT_TRUE(reload().success);
  EXPECT_TRUE(waitFor([&] { return obstacles_.newest().markers.size() == 4; }));
}

TEST_F(SimulatorTopicsTest, KeepsItsParametersWhereNewOnesCannotBe) {
  startNode();
  const auto refuses = [&](const std::string& name, const auto& value, const std::string& words) {
    parameters_.setParam(name, value);
    const std_srvs::TriggerResponse response = reload();
    EXPECT_FALSE(response.success) << name;
    EXPECT_NE(response.message.find(words), std::string::npos) << response.message;
    parameters_.deleteParam(name);
  };
  refuses("speed", -1.0, "speed");
  refuses("speed", std::string("fast"), "expected a number");
  refuses("driver", std::string("me"), "expected one of auto wall_follower commands");
  refuses("obstacles", -1, "obstacles");
  refuses("obstacles", 100000, "room for");
  refuses("sped", 1.0, "no parameter 'sped'");
  refuses("real_time_factor", 2.0, "/use_sim_time");
  refuses("start", std::string("-5 -2.65 0"), "cannot be changed while the simulator runs");
  EXPECT_TRUE(waitForScans(5));
}

TEST_F(SimulatorTopicsTest, RefusesToStartWithWhatCannotBe) {
  parameters_.setParam("start", std::string("-7.8 -4.3 0"));
  EXPECT_THROW(startNode(), ParameterError);
  parameters_.setParam("start", std::string("here"));
  EXPECT_THROW(startNode(), ParameterError);
  parameters_.deleteParam("start");
  parameters_.setParam("map", std::string("/nowhere/map.yaml"));
  EXPECT_THROW(startNode(), MapError);
  parameters_.deleteParam("map");
  EXPECT_THROW(startNode(), ParameterError);
}

TEST_F(SimulatorTopicsTest, TellsWhoeverSubscribesToInitialPoseOnceWhereItIs) {
  parameters_.setParam("announce_start", true);
  startNode();
  const MessageRecorder<geometry_msgs::PoseWithCovarianceStamped> first(handle_, "initialpose");
  ASSERT_TRUE(waitFor([&] { return first.count() > 0; }));
  EXPECT_LT(distance(toPose2(first.newest().pose.pose), start_), 1e-6);
  EXPECT_GT(first.newest().pose.covariance[0], 0.0);

  places_.publish(poseMessage({-5.0, -2.5, 0.0}));
  ASSERT_TRUE(waitFor([&] { return distance(baseInMap(), {-5.0, -2.5, 0.0}) < 1e-6; }));
  Process second({"rostopic", "echo", "-n", "1", namespace_ + "/initialpose"});
  EXPECT_EQ(second.wait(20.0), 0) << "received one";
  EXPECT_EQ(first.count(), 1) << "a later subscriber must not restart the localizer";
}

TEST_F(SimulatorTopicsTest, LeavesOdomTfToOthersWhereAsked) {
  parameters_.setParam("publish_odom_tf", false);
  std::atomic<int> transforms{0}, of_base_link{0};
  const auto onTransforms = [&](const tf2_msgs::TFMessageConstPtr& message) {
    ++transforms;
    for (const auto& transform : message->transforms) {
      of_base_link += transform.child_frame_id == "base_link";
    }
  };
  const ros::Subscriber subscriber =
      handle_.subscribe<tf2_msgs::TFMessage>("/tf", 100, onTransforms);
  startNode();
  ASSERT_TRUE(waitFor([&] { return transforms > 20; }));
  EXPECT_EQ(of_base_link, 0);
}

}  // namespace
}  // namespace racecar_mcl
