#include "ros/tf_odometry.h"

#include <tf2/exceptions.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <utility>
#include <vector>

#include "ros/conversions.h"

namespace racecar_mcl {

TfOdometry::TfOdometry(std::string odom_frame, std::string base_frame, double clock_jump)
    : odom_frame_(std::move(odom_frame)),
      base_frame_(std::move(base_frame)),
      clock_jump_(clock_jump) {}

bool TfOdometry::carriesBase(const std::string& frame) const {
  std::vector<std::string> seen;
  std::string carrier = base_frame_;
  while (carrier != odom_frame_ && std::find(seen.begin(), seen.end(), carrier) == seen.end()) {
    if (carrier == frame) return true;
    seen.push_back(carrier);
    std::string parent;
    if (!transforms_._getParent(carrier, ros::Time(0), parent)) return false;
    carrier = parent;
  }
  return false;
}

nav_msgs::OdometryConstPtr TfOdometry::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (geometry_msgs::TransformStamped transform : message.transforms) {
    transform.header.frame_id = stripLeadingSlash(transform.header.frame_id);
    transform.child_frame_id = stripLeadingSlash(transform.child_frame_id);
    if (!is_static && newest_ - transform.header.stamp >= clock_jump_ &&
        carriesBase(transform.child_frame_id)) {
      transforms_.clear();  // of what moves; static transforms stay
      newest_ = ros::Time();
    }
    transforms_.setTransform(transform, "tf", is_static);
  }
  geometry_msgs::TransformStamped base_in_odom;
  try {
    base_in_odom = transforms_.lookupTransform(odom_frame_, base_frame_, ros::Time(0));
  } catch (const tf2::TransformException&) {
    return nullptr;
  }
  // A way of static transforms alone has no stamp, and is no odometry.
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
