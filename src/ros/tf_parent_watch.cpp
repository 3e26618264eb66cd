#include "ros/tf_parent_watch.h"

#include <ros/console.h>
#include <ros/this_node.h>

#include "ros/conversions.h"

namespace racecar_mcl {

TfParentWatch::TfParentWatch(ros::NodeHandle node, const NodeParameters& parameters)
    : base_frame_(parameters.particle_filter_frame), map_frame_(parameters.map_frame) {
  if (parameters.tf_mode != TfMode::kMapToBase) return;
  tf_ = node.subscribe("/tf", 10, &TfParentWatch::onTransforms, this);
  tf_static_ = node.subscribe("/tf_static", 10, &TfParentWatch::onTransforms, this);
}

void TfParentWatch::onTransforms(const ros::MessageEvent<const tf2_msgs::TFMessage>& event) {
  if (said_) return;
  for (const auto& transform : event.getConstMessage()->transforms) {
    if (stripLeadingSlash(transform.child_frame_id) != base_frame_) continue;
    const std::string parent = stripLeadingSlash(transform.header.frame_id);
    // A nodelet beside this one publishes under the same name, but not from this one's map frame.
    if (parent == map_frame_ && event.getPublisherName() == ros::this_node::getName()) continue;
    if (parent == map_frame_) {
      ROS_WARN(
          "%s also publishes %s -> %s: two localizers contradict each other. Stop one, or "
          "set tf_mode to off here.",
          event.getPublisherName().c_str(), parent.c_str(), base_frame_.c_str());
    } else {
      ROS_WARN(
          "%s publishes %s -> %s, and so a second parent of %s, which tf cannot hold. Set "
          "tf_mode to map_to_odom and odom_frame to %s.",
          event.getPublisherName().c_str(), parent.c_str(), base_frame_.c_str(),
          base_frame_.c_str(), parent.c_str());
    }
    said_ = true;
    return;
  }
}

}  // namespace racecar_mcl
