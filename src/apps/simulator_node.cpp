// The simulated car as a program of its own: rosrun racecar_mcl simulator_node.
#include "ros/simulator_node.h"

#include <ros/ros.h>

#include <exception>

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulator");
  const ros::NodeHandle keeps_ros_running;  // else nobody hears what is said after an error
  try {
    const racecar_mcl::SimulatorNode node{ros::NodeHandle(), ros::NodeHandle("~")};
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("not simulating: %s", error.what());
    return 1;
  }
  return 0;
}
