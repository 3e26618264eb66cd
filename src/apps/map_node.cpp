// map_node [map.yaml]: the map source as a program. Without an argument it reads the parameter
// ~yaml_filename.
#include <filesystem>
#include <iostream>

#include "ros/map_source.h"
#include "ros_program.h"

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
  if (arguments.size() == 2) {
    // A parameter outlives this shell's folder, so it holds the whole path.
    ros::param::set("~yaml_filename", std::filesystem::absolute(arguments[1]).string());
  }
  return racecar_mcl::runNode<racecar_mcl::MapSource>("no map is served");
}
