// What every node that is a program of its own does alike.
#pragma once

#include <ros/ros.h>

#include <exception>

namespace racecar_mcl {

/// Runs a `Node` until ROS shuts down. Where it cannot be made, says "not_working: reason". Returns
/// the exit code.
template <typename Node>
int runNode(const char* not_working) {
  // Outlives the node: with the last node handle ROS shuts down, and its console falls silent.
  const ros::NodeHandle keeps_ros_running;
  try {
    const Node node{ros::NodeHandle(), ros::NodeHandle("~")};
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s: %s", not_working, error.what());
    return 1;
  }
  return 0;
}

}  // namespace racecar_mcl
