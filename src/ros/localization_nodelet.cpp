#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "ros/localization_node.h"

namespace racecar_mcl {

/// The localizer as a nodelet. Wrong parameters leave it loaded but unconfigured, with the reason
/// in the log.
class LocalizationNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    try {
      node_ = std::make_unique<LocalizationNode>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL("not localizing: %s", error.what());
    }
  }

  std::unique_ptr<LocalizationNode> node_;
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::LocalizationNodelet, nodelet::Nodelet)
