// Test fixture with a localization node in this process and a synthetic car.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <memory>
#include <string>

#include "ros/conversions/map_conversions.h"
#include "ros/localization/localization_node.h"
#include "support/localization_listener.h"
#include "support/synthetic_car.h"

namespace racecar_mcl {

/// The node's callbacks run in one thread, as those of a nodelet; the listener's in another. Topics
/// and parameters are in a namespace with the test's name.
class LocalizationTest : public ::testing::Test {
 protected:
  LocalizationTest()
      : namespace_("/" +
                   std::string(::testing::UnitTest::GetInstance()->current_test_info()->name())),
        handle_(namespace_),
        parameters_(namespace_ + "/localization"),
        listener_(handle_),
        spinner_(1),
        node_spinner_(1, &node_queue_),
        car_(ros::WallTime::now().toSec() - 1000.0),
        odometry_(handle_.advertise<nav_msgs::Odometry>("odom", 50)),
        scans_(handle_.advertise<sensor_msgs::LaserScan>("scan", 10)),
        map_(handle_.advertise<nav_msgs::OccupancyGrid>("map", 1, true)),
        initial_pose_(
            handle_.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 5)) {
    parameters_.setParam("diagnostics_rate", 50.0);
    parameters_.setParam("visualization_rate", 100.0);
    spinner_.start();
    node_spinner_.start();
  }

  ~LocalizationTest() override {
    node_.reset();
    node_spinner_.stop();
    spinner_.stop();
    ros::param::del(namespace_);
  }

  /// Throws as LocalizationNode.
  void startNode() {
    static_transforms_.sendTransform(car_.laserInBase());
    ros::NodeHandle node(namespace_);
    ros::NodeHandle private_node(namespace_ + "/localization");
    node.setCallbackQueue(&node_queue_);
    private_node.setCallbackQueue(&node_queue_);
    node_ = std::make_unique<LocalizationNode>(node, private_node);
    ASSERT_TRUE(listener_.waitFor([&] { return listener_.diagnostics().values.size() > 0; }));
  }

  void publishMap(const OccupancyGrid& grid = testRoom()) {
    map_.publish(toMessage(grid, "map", ros::Time(1.0)));
  }

  /// A start pose, as sent by rviz.
  static geometry_msgs::PoseWithCovarianceStamped startMessage(const Pose2& base_in_map,
                                                               double sigma = 0.1) {
    geometry_msgs::PoseWithCovarianceStamped message;
    message.header.frame_id = "map";
    message.pose.pose = toMessage(base_in_map);
    for (const std::size_t cell : {0U, 7U, 35U}) message.pose.covariance[cell] = sigma * sigma;
    return message;
  }

  /// Starts the node with the room's map at the car's pose.
  void startLocalized() {
    startNode();
    publishMap();
    ASSERT_TRUE(listener_.waitForLog("map of 162 x 122 cells"));
    const int starts = listener_.logged("localizing from");
    initial_pose_.publish(startMessage(car_.baseInMap()));
    ASSERT_TRUE(listener_.waitFor([&] { return listener_.logged("localizing from") > starts; }));
  }

  /// Called at each step of a drive, before its messages.
  virtual void onTick() {}

  /// Sends odometry at 50 Hz of simulated time and a scan with every second message, as fast as the
  /// node answers. Returns the number of answered scans.
  int drive(double seconds) {
    int answered = 0;
    for (int tick = 1; tick <= std::lround(seconds * 50.0); ++tick) {
      car_.advance(0.02);
      onTick();
      odometry_.publish(car_.odometry());
      if (tick % 2 == 0) answered += sendScan(car_.scan());
    }
    return answered;
  }

  /// Whether the node answered the scan with a pose.
  bool sendScan(const sensor_msgs::LaserScan& scan, double max_wait = 0.5) {
    const std::size_t before = listener_.scanPoseCount();
    scans_.publish(scan);
    return listener_.waitFor([&] { return listener_.scanPoseCount() > before; }, max_wait);
  }

  /// Continues the drive and expects the node to be localized.
  void expectStillLocalizes(double tolerance = 0.10) {
    EXPECT_GT(drive(1.0), 20);
    expectLocalized(tolerance);
  }

  void expectLocalized(double tolerance = 0.10) {
    ASSERT_TRUE(listener_.waitFor([&] {
      const auto newest = listener_.newestPose();
      return newest && newest->header.stamp.toSec() > car_.stamp() - 1e-5;
    })) << "no pose for now";
    const Pose2 pose = toPose2(listener_.newestPose()->pose.pose);
    EXPECT_LT(distance(pose, car_.baseInMap()), tolerance);
    EXPECT_LT(std::abs(wrapAngle(pose.yaw - car_.baseInMap().yaw)), 0.06);
  }

  std::string namespace_;
  ros::NodeHandle handle_;
  ros::NodeHandle parameters_;
  LocalizationListener listener_;
  ros::CallbackQueue node_queue_;
  ros::AsyncSpinner spinner_;
  ros::AsyncSpinner node_spinner_;
  SyntheticCar car_;
  tf2_ros::StaticTransformBroadcaster static_transforms_;
  tf2_ros::TransformBroadcaster transforms_;
  ros::Publisher odometry_, scans_, map_, initial_pose_;
  std::unique_ptr<LocalizationNode> node_;
};

}  // namespace racecar_mcl
