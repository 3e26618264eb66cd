// A simulator node in the test's process, and recorders of its topics.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/Twist.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Int32.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ros/conversions/message_conversions.h"
#include "ros/simulation/simulator_node.h"
#include "support/message_recorder.h"

namespace racecar_mcl {

/// The node's callbacks run in one thread, the test's in another. Topics and parameters lie in a
/// namespace of the test's name. The car stands at the corridor's start until it is commanded.
class SimulatorTest : public ::testing::Test {
 protected:
  SimulatorTest()
      : namespace_("/" +
                   std::string(::testing::UnitTest::GetInstance()->current_test_info()->name())),
        handle_(namespace_),
        parameters_(namespace_ + "/simulator"),
        truth_(handle_, "ground_truth/odom"),
        odometry_(handle_, "odom"),
        scan_(handle_, "scan"),
        obstacles_(handle_, "simulator/obstacles"),
        collisions_(handle_, "simulator/collisions"),
        spinner_(1),
        node_spinner_(1, &node_queue_),
        twists_(handle_.advertise<geometry_msgs::Twist>("cmd_vel", 5)),
        places_(handle_.advertise<geometry_msgs::PoseStamped>("simulator/place", 5)),
        points_(handle_.advertise<geometry_msgs::PointStamped>("simulator/add_obstacle", 5)),
        walkers_(
            handle_.advertise<geometry_msgs::PoseStamped>("simulator/add_moving_obstacle", 5)) {
    parameters_.setParam("map", std::string(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml"));
    parameters_.setParam("driver", std::string("commands"));
    // Few beams, so that tests are fast with sanitizers.
    parameters_.setParam("scan_beams", 61);
    parameters_.setParam("range_noise", 0.0);
    parameters_.setParam("missing_rate", 0.0);
    spinner_.start();
    node_spinner_.start();
  }

  ~SimulatorTest() override {
    node_.reset();
    node_spinner_.stop();
    spinner_.stop();
    ros::param::del(namespace_);
  }

  /// Throws as SimulatorNode.
  void startNode() {
    ros::NodeHandle node(namespace_);
    ros::NodeHandle private_node(namespace_ + "/simulator");
    node.setCallbackQueue(&node_queue_);
    private_node.setCallbackQueue(&node_queue_);
    node_ = std::make_unique<SimulatorNode>(node, private_node);
    ASSERT_TRUE(waitFor([&] {
      return truth_.count() > 0 && scan_.count() > 0 && odometry_.count() > 0 &&
             twists_.getNumSubscribers() > 0 && places_.getNumSubscribers() > 0 &&
             points_.getNumSubscribers() > 0 && walkers_.getNumSubscribers() > 0;
    }));
  }

  static bool waitFor(const std::function<bool()>& holds, double seconds = 10.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!holds()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  /// Waits for `scans` more scans, so that earlier requests have taken effect.
  bool waitForScans(int scans) {
    const int before = scan_.count();
    return waitFor([&] { return scan_.count() >= before + scans; });
  }

  Pose2 baseInMap() const { return toPose2(truth_.newest().pose.pose); }
  double speed() const { return truth_.newest().twist.twist.linear.x; }

  /// The range of the beam straight ahead, m.
  double rangeAhead() const {
    const sensor_msgs::LaserScan scan = scan_.newest();
    return static_cast<double>(scan.ranges.at(scan.ranges.size() / 2));
  }

  void drive(double speed, double turn_rate) {
    geometry_msgs::Twist twist;
    twist.linear.x = speed;
    twist.angular.z = turn_rate;
    twists_.publish(twist);
  }

  static geometry_msgs::PoseStamped poseMessage(const Pose2& in_map,
                                                const std::string& frame = "map") {
    geometry_msgs::PoseStamped message;
    message.header.frame_id = frame;
    message.pose = toMessage(in_map);
    return message;
  }

  static geometry_msgs::PointStamped pointMessage(double x, double y) {
    geometry_msgs::PointStamped message;
    message.header.frame_id = "map";
    message.point.x = x;
    message.point.y = y;
    return message;
  }

  std_srvs::TriggerResponse reload() {
    std_srvs::Trigger request;
    EXPECT_TRUE(ros::service::call(namespace_ + "/simulator/reload_parameters", request));
    return request.response;
  }

  const Pose2 start_{-7.8, -2.65, 0.0};  // maps/corridor_start.yaml
  const std::string namespace_;
  ros::NodeHandle handle_;
  ros::NodeHandle parameters_;
  MessageRecorder<nav_msgs::Odometry> truth_;
  MessageRecorder<nav_msgs::Odometry> odometry_;
  MessageRecorder<sensor_msgs::LaserScan> scan_;
  MessageRecorder<visualization_msgs::MarkerArray> obstacles_;
  MessageRecorder<std_msgs::Int32> collisions_;
  ros::AsyncSpinner spinner_;
  ros::CallbackQueue node_queue_;
  ros::AsyncSpinner node_spinner_;
  ros::Publisher twists_, places_, points_, walkers_;
  std::unique_ptr<SimulatorNode> node_;
};

}  // namespace racecar_mcl
