// Detects other publishers of a parent of the localized frame; a tf frame has one parent.
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <tf2_msgs/TFMessage.h>

#include <atomic>
#include <string>

#include "ros/localization/node_parameters.h"

namespace racecar_mcl {

class TfConflictDetector {
 public:
  /// With tf_mode map_to_base: warns once if another node publishes a parent of the localized
  /// frame, and names the tf_mode to use.
  TfConflictDetector(ros::NodeHandle node, const NodeParameters& parameters);

 private:
  void onTransforms(const ros::MessageEvent<const tf2_msgs::TFMessage>& event);

  std::string base_frame_;
  std::string map_frame_;
  std::atomic<bool> reported_{false};
  ros::Subscriber tf_;
  ros::Subscriber tf_static_;
};

}  // namespace racecar_mcl
