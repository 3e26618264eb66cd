// Map server, simulator and localizer as nodelets of one process, with all callbacks at once. Built
// with ThreadSanitizer, it checks what runs in a nodelet manager.
#include "support/nodelet_host.h"

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>
#include <visualization_msgs/MarkerArray.h>

#include <cmath>
#include <string>

#include "support/localization_listener.h"
#include "support/message_recorder.h"
#include "support/program.h"

namespace racecar_mcl {
namespace {

const std::string kLocalizer = "/localization";

class NodeletHostTest : public ::testing::Test {
 protected:
  NodeletHostTest() : listener_(handle_), truth_(handle_, "ground_truth/odom"), spinner_(2) {
    spinner_.start();
    ros::param::set("/map_server/yaml_filename",
                    std::string(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml"));
    ros::param::set("/simulator/map", std::string(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml"));
    // Few beams and particles, so that scans arrive in time with sanitizers.
    ros::param::set("/simulator/scan_beams", 121);
    ros::param::set(kLocalizer + "/num_particles", 200);
    ros::param::set(kLocalizer + "/tf_mode", std::string("map_to_odom"));
  }
  ~NodeletHostTest() override { spinner_.stop(); }

  void loadAll() {
    ASSERT_TRUE(host_.load("/map_server", "MapServer"));
    ASSERT_TRUE(host_.load(kLocalizer, "LocalizationNode"));
    ASSERT_TRUE(host_.load("/simulator", "SimulatorNode"));
    ASSERT_TRUE(listener_.waitFor([&] { return truth_.count() > 0; }, 20.0));
    starts_.publish(truePose());
    ASSERT_TRUE(waitForScans(1));
  }

  bool waitForScans(std::size_t count) {
    const std::size_t before = listener_.scanPoseCount();
    return listener_.waitFor([&] { return listener_.scanPoseCount() >= before + count; }, 20.0);
  }

  template <typename Service>
  bool call(const std::string& name) {
    Service service;
    return ros::service::call(name, service);
  }

  /// Every request that the nodes take while they run.
  void requestEverything() {
    points_.publish(geometry_msgs::PointStamped());
    starts_.publish(truePose());
    EXPECT_TRUE(call<std_srvs::Empty>("/global_localization"));
    EXPECT_TRUE(call<std_srvs::Empty>("/request_nomotion_update"));
    EXPECT_TRUE(call<std_srvs::Trigger>(kLocalizer + "/reload_parameters"));
    EXPECT_TRUE(call<std_srvs::Trigger>("/map_server/reload"));
    EXPECT_TRUE(call<std_srvs::Trigger>("/simulator/reload_parameters"));
  }

  geometry_msgs::PoseWithCovarianceStamped truePose() const {
    geometry_msgs::PoseWithCovarianceStamped start;
    start.header.frame_id = "map";
    start.header.stamp = truth_.newest().header.stamp;
    start.pose.pose = truth_.newest().pose.pose;
    for (const std::size_t cell : {0U, 7U, 35U}) start.pose.covariance[cell] = 0.01;
    return start;
  }

  bool isLocalized() const {
    const auto pose = listener_.newestPose();
    return pose && listener_.diagnostic("status") == "localized" &&
           std::hypot(pose->pose.pose.position.x - truth_.newest().pose.pose.position.x,
                      pose->pose.pose.position.y - truth_.newest().pose.pose.position.y) < 0.5;
  }

  ros::NodeHandle handle_;
  LocalizationListener listener_;
  MessageRecorder<nav_msgs::Odometry> truth_;
  ros::Publisher starts_ =
      handle_.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 2);
  ros::Publisher points_ = handle_.advertise<geometry_msgs::PointStamped>("clicked_point", 2);
  ros::AsyncSpinner spinner_;
  NodeletHost host_;
};

TEST_F(NodeletHostTest, LocalizesAfterAllRequestsAtOnce) {
  loadAll();
  // Subscribers make the localizer draw and detect obstacles.
  const MessageRecorder<visualization_msgs::MarkerArray> tracks(handle_, "pf/viz/obstacles");
  const MessageRecorder<sensor_msgs::PointCloud2> obstacles(handle_, "pf/obstacles");
  for (int round = 0; round < 3; ++round) {
    requestEverything();
    EXPECT_TRUE(waitForScans(3));
  }
  ASSERT_TRUE(waitForScans(5));
  starts_.publish(truePose());
  EXPECT_TRUE(listener_.waitFor([&] { return isLocalized(); }, 20.0));
  EXPECT_GT(obstacles.count(), 0);
}

TEST_F(NodeletHostTest, LoadsAndUnloadsNodeletsWhileTheOthersRun) {
  loadAll();
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(host_.unload(kLocalizer));
    EXPECT_TRUE(host_.load(kLocalizer, "LocalizationNode"));
    starts_.publish(truePose());
    EXPECT_TRUE(host_.unload("/map_server"));
    EXPECT_TRUE(host_.load("/map_server", "MapServer"));
  }
  EXPECT_TRUE(waitForScans(5));
}

#ifdef __SANITIZE_THREAD__
TEST(ThreadSanitizer, ReportsARaceOfTwoCallbacks) {
  const ProgramResult result = runProgram(RACECAR_MCL_PROGRAM_DIR "/injected_race", {});
  EXPECT_NE(result.exit_code, 0);
  EXPECT_NE(result.err.find("data race"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("countUnguarded"), std::string::npos) << result.err;
}
#endif

}  // namespace
}  // namespace racecar_mcl
