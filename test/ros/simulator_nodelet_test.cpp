// The simulator as a nodelet and as a program.
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <sensor_msgs/LaserScan.h>

#include "support/localization_listener.h"
#include "support/program.h"

namespace racecar_mcl {
namespace {

class SimulatorNodeletTest : public ::testing::Test {
 protected:
  SimulatorNodeletTest() : spinner_(1), listener_(node_) {
    spinner_.start();
    EXPECT_TRUE(ros::service::waitForService("/manager/load_nodelet", 20000));
    EXPECT_TRUE(listener_.waitForLogOf(2)) << "logs of the manager and of this process";
  }

  static bool load(const std::string& name) {
    nodelet::NodeletLoad request;
    request.request.name = name;
    request.request.type = "racecar_mcl/SimulatorNodelet";
    return ros::service::call("/manager/load_nodelet", request) && request.response.success;
  }
  static bool unload(const std::string& name) {
    nodelet::NodeletUnload request;
    request.request.name = name;
    return ros::service::call("/manager/unload_nodelet", request) && request.response.success;
  }
  static bool scanComes(double seconds) {
    return ros::topic::waitForMessage<sensor_msgs::LaserScan>("/scan", ros::Duration(seconds)) !=
           nullptr;
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  LocalizationListener listener_;
};

TEST_F(SimulatorNodeletTest, DrivesUntilItIsUnloaded) {
  ASSERT_TRUE(load("/simulator"));
  EXPECT_TRUE(scanComes(10.0));
  ASSERT_TRUE(unload("/simulator"));
  EXPECT_FALSE(scanComes(0.5));
  ASSERT_TRUE(load("/simulator"));
  EXPECT_TRUE(scanComes(10.0));
  ASSERT_TRUE(unload("/simulator"));
}

TEST_F(SimulatorNodeletTest, SaysWhyItDoesNotDrive) {
  ASSERT_TRUE(load("/mistaken"));
  EXPECT_TRUE(listener_.waitForLog("not simulating: speed is -1 m/s"));
  EXPECT_FALSE(scanComes(0.5));
}

TEST(SimulatorProgram, EndsWithAWordWhereItHasNoMap) {
  const ProgramResult result =
      runProgram(RACECAR_MCL_PROGRAM_DIR "/simulator_node", {"__name:=without_map"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE((result.out + result.err).find("map is not set"), std::string::npos)
      << result.out << result.err;
}

}  // namespace
}  // namespace racecar_mcl
