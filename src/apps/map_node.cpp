// map_node [map.yaml]: the map server as a program. Without an argument it reads the parameter
// ~yaml_filename.
#include <filesystem>

#include "ros/map_server/map_server.h"
#include "ros_main.h"

namespace {

constexpr char kUsage[] =
    "usage: map_node [map.yaml] [ROS remappings]\n"
    "Publishes the map on `map` and `map_metadata` and serves it as `static_map`.\n"
    "Without an argument the parameter ~yaml_filename names the map.\n";

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments = racecar_mcl::programArguments(argc, argv);
  if (const auto code = racecar_mcl::printUsage(arguments, 1, kUsage)) return *code;
  ros::init(argc, argv, "map_node");
  if (!arguments.empty()) {
    // Absolute, because the parameter may be read from another working directory.
    ros::param::set("~yaml_filename", std::filesystem::absolute(arguments[0]).string());
  }
  return racecar_mcl::runNode<racecar_mcl::MapServer>("not serving a map");
}
