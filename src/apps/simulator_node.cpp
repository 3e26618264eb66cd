// The simulator node as a program: rosrun racecar_mcl simulator_node.
#include "ros/simulation/simulator_node.h"

#include "ros_main.h"

namespace {

constexpr char kUsage[] =
    "usage: simulator_node [_parameter:=value...] [ROS remappings]\n"
    "Simulates a car with odometry and lidar on a map, and publishes the clock. Needs\n"
    "_map:=MAP.yaml; docs/simulator.md lists the parameters and topics. simulate.launch\n"
    "starts it with a map and, with localize:=true, the localizer.\n";

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments = racecar_mcl::programArguments(argc, argv);
  if (const auto code = racecar_mcl::printUsage(arguments, 0, kUsage)) return *code;
  ros::init(argc, argv, "simulator");
  return racecar_mcl::runNode<racecar_mcl::SimulatorNode>("not simulating");
}
