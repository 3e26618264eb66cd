// Odometry from tf, for robots that publish odom -> base_link but no odometry topic.
#pragma once

#include <nav_msgs/Odometry.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <string>

namespace racecar_mcl {

class TfOdometry {
 public:
  /// Frames without a leading slash. A stamp `clock_jump` seconds older than the newest means that
  /// time started again: what was heard before is forgotten.
  TfOdometry(std::string odom_frame, std::string base_frame, double clock_jump);

  /// Takes in a message of /tf or /tf_static. Returns the newest pose of the base in the odometry
  /// frame, with its own stamp and without a twist, where the message brought a newer one; else
  /// null. The way between the two frames may lead over others (odom -> base_footprint ->
  /// base_link).
  nav_msgs::OdometryConstPtr add(const tf2_msgs::TFMessage& message, bool is_static);

 private:
  bool carriesBase(const std::string& frame) const;

  std::string odom_frame_;
  std::string base_frame_;
  ros::Duration clock_jump_;
  tf2::BufferCore transforms_;
  ros::Time newest_;
};

}  // namespace racecar_mcl
