// Part of LocalizationNode: odometry, transforms and scans, and checks of their stamps and frames.
#include <cmath>
#include <set>
#include <string>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/printable.h"
#include "ros/localization/localization_node.h"

namespace racecar_mcl {
namespace {

// Stamps further than this from the clock belong to a bag, or are wrong.
constexpr double kMaxClockOffset = 10.0;  // s
// Simulated time arrives by messages, which a busy processor delays: by 10 s, at up to a hundred
// times real time.
constexpr double kMaxSimulatedClockOffset = 1000.0;  // s

}  // namespace

void LocalizationNode::subscribeScans() {
  std::set<std::string> names;
  for (const std::string& topic : parameters_.scan_topics) {
    if (!names.insert(node_.resolveName(topic)).second) {
      throw ParameterError("scan_topics names " + node_.resolveName(topic) +
                           " twice; expected a topic of its own for each lidar");
    }
    if (parameters_.scan_topics.size() > 1) watchdog_.expectLidar(topic);
  }
  for (const std::string& topic : parameters_.scan_topics) {
    const boost::function<void(const sensor_msgs::LaserScanConstPtr&)> take =
        [this, topic](const sensor_msgs::LaserScanConstPtr& message) { onScan(topic, message); };
    subscribers_.push_back(node_.subscribe<sensor_msgs::LaserScan>(
        topic, 2, take, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
}

void LocalizationNode::subscribeOdometry() {
  if (parameters_.localizer.odometry.motion_from != MotionFrom::kTf) {
    subscribers_.push_back(node_.subscribe("odom", 50, &LocalizationNode::onOdometry, this,
                                           ros::TransportHints().tcpNoDelay()));
    return;
  }
  for (const bool is_static : {true, false}) {
    const boost::function<void(const tf2_msgs::TFMessageConstPtr&)> take =
        [this, is_static](const tf2_msgs::TFMessageConstPtr& message) {
          onTransforms(message, is_static);
        };
    subscribers_.push_back(node_.subscribe<tf2_msgs::TFMessage>(
        is_static ? "/tf_static" : "/tf", 100, take, ros::VoidConstPtr(),
        ros::TransportHints().tcpNoDelay()));
  }
}

void LocalizationNode::onTransforms(const tf2_msgs::TFMessageConstPtr& message, bool is_static) {
  if (const nav_msgs::OdometryConstPtr odometry = tf_odometry_.add(*message, is_static)) {
    onOdometry(odometry);
  }
}

void LocalizationNode::onOdometry(const nav_msgs::OdometryConstPtr& message) {
  if (hasInvalidStamp("odometry", message->header.stamp)) return;
  const OdometrySample sample = toOdometrySample(*message);
  checkOdometryFrames(*message, sample);
  const OdometryOutcome outcome = localizer_.addOdometry(sample);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    odometry_frame_ = stripLeadingSlash(message->child_frame_id);
    if (isUsed(outcome)) {
      watchdog_.recordOdometry(ros::Time::now().toSec());
      if (isFinite(sample.base_in_odom)) {
        base_in_odom_ = sample.base_in_odom;
        base_in_odom_stamp_ = sample.stamp;
      }
    }
    if (outcome == OdometryOutcome::kTimeJumpedBack) last_published_stamp_ = 0.0;
  }
  odometry_arrived_.notify_one();
  switch (outcome) {
    case OdometryOutcome::kUsed:
      break;
    case OdometryOutcome::kTimeJumpedBack:
      worker_.post([this, stamp = sample.stamp] { restartAfterTimeJump(stamp); });
      break;
    case OdometryOutcome::kGap:
      warnThrottled("odometry", toString(outcome));
      break;
    default:
      recordProblem(toString(outcome));
      warnThrottled("odometry dropped", toString(outcome));
      return;
  }
  if (localizer_.initialized()) publishPose(false);
}

void LocalizationNode::checkOdometryFrames(const nav_msgs::Odometry& message,
                                           const OdometrySample& sample) {
  if (parameters_.tf_mode != TfMode::kMapToOdom) return;
  const std::string frame = stripLeadingSlash(message.header.frame_id);
  if (!frame.empty() && frame != parameters_.odom_frame) {
    warnThrottled("odom_frame", "odometry is given in '" + printable(frame) + "' but tf goes to '" +
                                    parameters_.odom_frame +
                                    "'; expected both to be the same frame");
  }
  if (!isFinite(sample.base_in_odom)) {
    warnThrottled("odometry", "no valid pose; tf_mode map_to_odom requires one");
  }
}

void LocalizationNode::onScan(const std::string& topic,
                              const sensor_msgs::LaserScanConstPtr& message) {
  if (hasInvalidStamp("scan", message->header.stamp)) return;
  const ros::WallTime now = ros::WallTime::now();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const int lidar = lidars_.find(stripLeadingSlash(message->header.frame_id));
    if (!scan_queue_.add(message->header.stamp.toSec(), now.toSec(), {message, now, topic},
                         lidar)) {
      ++node_status_.scans_superseded;  // the worker already has a task for it
      return;
    }
  }
  worker_.post([this] { processScan(); });
}

bool LocalizationNode::hasInvalidStamp(const std::string& what, const ros::Time& stamp) {
  std::string problem;
  const ros::Time now = ros::Time::now();
  const double max_offset = ros::Time::isSystemTime() ? kMaxClockOffset : kMaxSimulatedClockOffset;
  if (stamp.isZero()) {
    problem = "the stamp is zero; expected the time of measurement";
  } else if (!now.isZero() && stamp.toSec() - now.toSec() > max_offset) {
    // tf listeners that received such a stamp would reject all later valid stamps.
    problem = "the stamp is more than " + std::to_string(std::lround(max_offset)) +
              " s ahead of the clock; play bags with --clock and use_sim_time";
  } else {
    return false;
  }
  recordProblem(what + " dropped: " + problem, &NodeStatus::stamps_rejected);
  warnThrottled(what + " dropped", problem);
  return true;
}

void LocalizationNode::restartAfterTimeJump(double stamp) {
  // A live clock may be set back while the car drives; a looping bag also resets the car's pose.
  const bool live =
      ros::Time::isSystemTime() && std::abs(ros::Time::now().toSec() - stamp) < kMaxClockOffset;
  const bool restart = parameters_.initial_pose && !live;
  if (log_throttle_.isDue()) {
    ROS_WARN("time jumped back (%s): odometry was reset%s", live ? "clock set back" : "bag loop",
             restart ? "; starting at initial_pose" : "; the pose is kept");
  }
  if (restart) start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});
}

}  // namespace racecar_mcl
