// The localizer as a nodelet.
#include <pluginlib/class_list_macros.hpp>

#include "ros/localization/localization_node.h"
#include "ros/util/nodelet_adapter.h"

namespace racecar_mcl {

struct LocalizationNodelet : NodeletAdapter<LocalizationNode> {
  LocalizationNodelet() : NodeletAdapter("not localizing") {}
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::LocalizationNodelet, nodelet::Nodelet)
