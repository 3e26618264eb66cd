// The localizer as a program of its own: rosrun racecar_mcl localization_node.
#include "ros/localization_node.h"

#include <ros/ros.h>

#include <exception>

int main(int argc, char** argv) {
  ros::init(argc, argv, "localization");
  const ros::NodeHandle keeps_ros_running;  // else nobody hears what is said after an error
  try {
    const racecar_mcl::LocalizationNode node{ros::NodeHandle(), ros::NodeHandle("~")};
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("not localizing: %s", error.what());
    return 1;
  }
  return 0;
}
