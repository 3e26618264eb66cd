#include "ros/localization/tf_odometry.h"

#include <tf2/exceptions.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <utility>
#include <vector>

#include "ros/conversions/message_conversions.h"
#include "ros/util/tf_ancestors.h"

namespace racecar_mcl {

TfOdometry::TfOdometry(std::string odom_frame, std::string base_frame, double clock_jump)
    : odom_frame_(std::move(odom_frame)),
      base_frame_(std::move(base_frame)),
      clock_jump_(clock_jump) {}

bool TfOdometry::carriesBase(const std::string& frame) const {
  const std::vector<std::string> chain = ancestorsBelow({odom_frame_}, transforms_, base_frame_);
  return std::find(chain.begin(), chain.end(), frame) != chain.end();
}

bool TfOdometry::checkStamp(const geometry_msgs::TransformStamped& transform) {
  const std::string& frame = transform.child_frame_id;
  ClockJumpDetector& detector = clock_jumps_.try_emplace(frame, clock_jump_).first->second;
  const double stamp = transform.header.stamp.toSec();
  const StampCheck check = detector.check(stamp, detector.newest().value_or(stamp) + clock_jump_);
  if (check == StampCheck::kClockJump && transform.header.stamp < newest_ && carriesBase(frame)) {
    transforms_.clear();  // keeps static transforms
    newest_ = ros::Time();
  }
  return check != StampCheck::kOutlier;
}

nav_msgs::OdometryConstPtr TfOdometry::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    transform.header.frame_id = stripLeadingSlash(transform.header.frame_id);
    transform.child_frame_id = stripLeadingSlash(transform.child_frame_id);
    if (!is_static && !checkStamp(transform)) continue;
    transforms_.setTransform(transform, "tf", is_static);
  }
  geometry_msgs::TransformStamped base_in_odom;
  try {
    base_in_odom = transforms_.lookupTransform(odom_frame_, base_frame_, ros::Time(0));
  } catch (const tf2::TransformException&) {
    return nullptr;
  }
  // A chain of static transforms has no stamp and is no odometry.
  if (base_in_odom.header.stamp <= newest_) return nullptr;
  newest_ = base_in_odom.header.stamp;

  const auto odometry = boost::make_shared<nav_msgs::Odometry>();
  odometry->header.stamp = base_in_odom.header.stamp;
  odometry->header.frame_id = odom_frame_;
  odometry->child_frame_id = base_frame_;
  odometry->pose.pose.position.x = base_in_odom.transform.translation.x;
  odometry->pose.pose.position.y = base_in_odom.transform.translation.y;
  odometry->pose.pose.orientation = base_in_odom.transform.rotation;
  return odometry;
}

}  // namespace racecar_mcl
