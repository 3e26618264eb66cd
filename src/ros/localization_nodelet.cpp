// The localizer as a nodelet.
#include <pluginlib/class_list_macros.hpp>

#include "ros/localization_node.h"
#include "ros/nodelet_of.h"

namespace racecar_mcl {

struct LocalizationNodelet : NodeletOf<LocalizationNode> {
  LocalizationNodelet() : NodeletOf("not localizing") {}
};

}  // namespace racecar_mcl

PLUGINLIB_EXPORT_CLASS(racecar_mcl::LocalizationNodelet, nodelet::Nodelet)
