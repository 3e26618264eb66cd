// main() of the node programs.
#pragma once

#include <ros/ros.h>

#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace racecar_mcl {

/// The arguments that are not ROS remappings, without the program's name.
inline std::vector<std::string> programArguments(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  arguments.erase(arguments.begin());
  return arguments;
}

/// Prints `usage` if it is asked for, or if there are more than `max_arguments`. Returns the exit
/// code then. Needs no master.
inline std::optional<int> printUsage(const std::vector<std::string>& arguments,
                                     std::size_t max_arguments, const char* usage) {
  for (const std::string& argument : arguments) {
    if (argument != "-h" && argument != "--help") continue;
    std::cout << usage;
    return 0;
  }
  if (arguments.size() <= max_arguments) return std::nullopt;
  std::cerr << "unknown argument '" << arguments[max_arguments] << "'\n" << usage;
  return 1;
}

/// Runs a `Node` until ROS shuts down. If its constructor throws, logs "not_working: reason".
/// Returns the exit code.
template <typename Node>
int runNode(const char* not_working) {
  // Outlives the node: with the last node handle ROS shuts down and stops logging.
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
