// The localization node as a program: rosrun racecar_mcl localization_node.
#include "ros/localization/localization_node.h"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "ros_main.h"

namespace {

constexpr char kUsage[] =
    "usage: localization_node [_parameter:=value...] [ROS remappings]\n"
    "Localizes a car by its odometry (topic odom), lidar (scan) and map (map), and publishes\n"
    "its pose (pf/pose/odom, tf) and status (pf/status). docs/parameters.md lists the\n"
    "parameters, README.md the topics. localize.launch starts it as a nodelet, with a map.\n";

/// The temporaries of building a map are many times larger than what tracking allocates. glibc
/// would keep their pages; blocks that are mapped one by one go back when they are freed.
void returnLargeBlocksWhenFreed() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 64 * 1024);  // bytes
  mallopt(M_TRIM_THRESHOLD, 64 * 1024);  // bytes
#endif
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments = racecar_mcl::programArguments(argc, argv);
  if (const auto code = racecar_mcl::printUsage(arguments, 0, kUsage)) return *code;
  returnLargeBlocksWhenFreed();
  ros::init(argc, argv, "localization");
  return racecar_mcl::runNode<racecar_mcl::LocalizationNode>("not localizing");
}
