// Odometry from tf, for robots that publish odom -> base_link but no odometry topic.
#pragma once

#include <nav_msgs/Odometry.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <string>

#include "racecar_mcl/motion/clock_jump_detector.h"

namespace racecar_mcl {

class TfOdometry {
 public:
  /// Frames without a leading slash. Two stamps `clock_jump` seconds older than the newest are a
  /// time jump and clear the buffered transforms; one that is so much older or newer is dropped.
  TfOdometry(std::string odom_frame, std::string base_frame, double clock_jump);

  /// Adds a message of /tf or /tf_static. Returns the newest pose of the base in the odometry
  /// frame, with its stamp and without a twist, if the message contained a newer one; else null.
  /// Other frames may lie between the two (odom -> base_footprint -> base_link).
  nav_msgs::OdometryConstPtr add(const tf2_msgs::TFMessage& message, bool is_static);

 private:
  bool carriesBase(const std::string& frame) const;
  /// False if the stamp is an outlier. Clears the buffered transforms on a jump back.
  bool checkStamp(const geometry_msgs::TransformStamped& transform);

  std::string odom_frame_;
  std::string base_frame_;
  double clock_jump_;                                     ///< s
  std::map<std::string, ClockJumpDetector> clock_jumps_;  ///< by child frame
  tf2::BufferCore transforms_;
  ros::Time newest_;
};

}  // namespace racecar_mcl
