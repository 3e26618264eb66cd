// The simulator as a nodelet.
#include <pluginlib/class_list_macros.hpp>

#include "ros/simulation/simulator_node.h"
#include "ros/util/nodelet_adapter.h"

namespace racecar_mcl {

struct SimulatorNodelet : NodeletAdapter<SimulatorNode> {
  SimulatorNodelet() : NodeletAdapter("not simulating") {}
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::SimulatorNodelet, nodelet::Nodelet)
