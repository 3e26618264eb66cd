// The simulated car as a nodelet.
#include <pluginlib/class_list_macros.hpp>

#include "ros/nodelet_of.h"
#include "ros/simulator_node.h"

namespace racecar_mcl {

struct SimulatorNodelet : NodeletOf<SimulatorNode> {
  SimulatorNodelet() : NodeletOf("not simulating") {}
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::SimulatorNodelet, nodelet::Nodelet)
