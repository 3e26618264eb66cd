#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "ros/simulator_node.h"

namespace racecar_mcl {

/// The simulated car as a nodelet. Wrong parameters leave it loaded but unconfigured, with the
/// reason in the log.
class SimulatorNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    try {
      node_ = std::make_unique<SimulatorNode>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL("not simulating: %s", error.what());
    }
  }

  std::unique_ptr<SimulatorNode> node_;
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::SimulatorNodelet, nodelet::Nodelet)
