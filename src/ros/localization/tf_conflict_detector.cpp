#include "ros/localization/tf_conflict_detector.h"

#include <ros/console.h>
#include <ros/this_node.h>

#include "racecar_mcl/common/printable.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {

TfConflictDetector::TfConflictDetector(ros::NodeHandle node, const NodeParameters& parameters)
    : base_frame_(parameters.particle_filter_frame), map_frame_(parameters.map_frame) {
  if (parameters.tf_mode != TfMode::kMapToBase) return;
  tf_ = node.subscribe("/tf", 10, &TfConflictDetector::onTransforms, this);
  tf_static_ = node.subscribe("/tf_static", 10, &TfConflictDetector::onTransforms, this);
}

void TfConflictDetector::onTransforms(const ros::MessageEvent<const tf2_msgs::TFMessage>& event) {
  if (reported_) return;
  for (const auto& transform : event.getConstMessage()->transforms) {
    if (stripLeadingSlash(transform.child_frame_id) != base_frame_) continue;
    const std::string parent = stripLeadingSlash(transform.header.frame_id);
    // Other nodelets of this process have the same publisher name but another map frame.
    if (parent == map_frame_ && event.getPublisherName() == ros::this_node::getName()) continue;
    if (parent == map_frame_) {
      ROS_WARN(
          "%s also publishes %s -> %s: two localizers are running. Stop one, or set tf_mode to off "
          "here.",
          printable(event.getPublisherName()).c_str(), parent.c_str(), base_frame_.c_str());
    } else {
      ROS_WARN(
          "%s publishes %s -> %s, a second parent of %s, which tf does not support. Set tf_mode to "
          "map_to_odom and odom_frame to %s.",
          printable(event.getPublisherName()).c_str(), printable(parent).c_str(),
          base_frame_.c_str(), base_frame_.c_str(), printable(parent).c_str());
    }
    reported_ = true;
    return;
  }
}

}  // namespace racecar_mcl
