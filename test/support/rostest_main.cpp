// The main() of the test programs that rostest starts: gtest inside a ROS node.
#include <gtest/gtest.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rostest");
  const ros::NodeHandle keeps_ros_running;
  return RUN_ALL_TESTS();
}
