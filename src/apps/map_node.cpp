// map_node [map.yaml]: the map source as a program. Without an argument it reads the parameter
// ~yaml_filename.
#include <ros/ros.h>

#include <filesystem>
#include <iostream>

#include "ros/map_source.h"

int main(int argc, char** argv) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  const bool asks_for_help =
      arguments.size() == 2 && (arguments[1] == "-h" || arguments[1] == "--help");
  if (asks_for_help || arguments.size() > 2) {
    (asks_for_help ? std::cout : std::cerr)
        << "usage: map_node [map.yaml]\n"
           "Publishes the map on `map` and `map_metadata` and serves it as `static_map`.\n"
           "Without an argument the parameter ~yaml_filename names the map.\n";
    return asks_for_help ? 0 : 1;
  }

  ros::init(argc, argv, "map_node");
  // Outside the try block: with the last node handle ROS shuts down, and its console falls silent.
  ros::NodeHandle private_node("~");
  try {
    if (arguments.size() == 2) {
      // A parameter outlives this shell's folder, so it holds the whole path.
      private_node.setParam("yaml_filename", std::filesystem::absolute(arguments[1]).string());
    }
    const racecar_mcl::MapSource source(ros::NodeHandle(), private_node);
    ros::spin();
  } catch (const std::exception& e) {
    ROS_FATAL_STREAM("no map is served: " << e.what());
    return 1;
  }
  return 0;
}
