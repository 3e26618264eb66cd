// Watches tf for somebody else who says where base_link is: a frame has one parent.
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <tf2_msgs/TFMessage.h>

#include <atomic>
#include <string>

#include "ros/node_parameters.h"

namespace racecar_mcl {

class TfParentWatch {
 public:
  /// Says it once, with the tf_mode that fits, when another node publishes a parent of the
  /// localized frame that this mode publishes too.
  TfParentWatch(ros::NodeHandle node, const NodeParameters& parameters);

 private:
  void onTransforms(const ros::MessageEvent<const tf2_msgs::TFMessage>& event);

  std::string base_frame_;
  std::string map_frame_;
  std::atomic<bool> said_{false};
  ros::Subscriber tf_;
  ros::Subscriber tf_static_;
};

}  // namespace racecar_mcl
