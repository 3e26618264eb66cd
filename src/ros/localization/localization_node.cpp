#include "ros/localization/localization_node.h"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <cstdio>

#include "racecar_mcl/common/printable.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {
namespace {

constexpr double kTimeoutCheckPeriod = 0.1;  // s of wall time, between checks for input timeouts

/// The same node handle with another callback queue.
ros::NodeHandle withQueue(ros::NodeHandle node, ros::CallbackQueue* queue) {
  node.setCallbackQueue(queue);
  return node;
}

}  // namespace

LocalizationNode::LocalizationNode(ros::NodeHandle node, ros::NodeHandle private_node)
    : parameters_(readNodeParameters(private_node)),
      node_(node),
      private_node_(private_node),
      name_(private_node.getNamespace()),
      localizer_(parameters_.localizer, static_cast<std::uint64_t>(parameters_.seed)),
      watchdog_(parameters_.input_timeout),
      publisher_(node, parameters_),
      obstacle_publisher_(node, parameters_),
      tf_node_(withQueue(node, &tf_queue_)),
      lidar_extrinsics_(tf_node_, parameters_),
      imu_rotation_(lidar_extrinsics_),
      tf_conflict_detector_(tf_node_, parameters_),
      tf_odometry_(parameters_.odom_frame, parameters_.particle_filter_frame,
                   parameters_.localizer.odometry.clock_jump),
      reload_node_(withQueue(private_node, &reload_queue_)) {
  diagnostics_publisher_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  readLastPose();
  if (parameters_.initial_pose && !saved_pose_)
    start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});

  subscribeScans();
  subscribers_.push_back(node_.subscribe("map", 1, &LocalizationNode::onMap, this));
  subscribers_.push_back(node_.subscribe("initialpose", 2, &LocalizationNode::onInitialPose, this));
  subscribers_.push_back(
      node_.subscribe("clicked_point", 2, &LocalizationNode::onClickedPoint, this));
  subscribeOdometry();
  subscribers_.push_back(node_.subscribe("imu", 50, &LocalizationNode::onImu, this,
                                         ros::TransportHints().tcpNoDelay()));
  services_ = {
      node_.advertiseService("global_localization", &LocalizationNode::onGlobalLocalization, this),
      node_.advertiseService("request_nomotion_update", &LocalizationNode::onNoMotionUpdate, this),
      node_.advertiseService("set_map", &LocalizationNode::onSetMap, this)};
  advertisePrivateServices();
  reload_spinner_.start();
  status_timer_ = node_.createWallTimer(ros::WallDuration(kTimeoutCheckPeriod),
                                        &LocalizationNode::onStatusTimer, this);
  diagnostics_timer_ = node_.createWallTimer(ros::WallDuration(1.0 / parameters_.diagnostics_rate),
                                             &LocalizationNode::onDiagnosticsTimer, this);
}

LocalizationNode::~LocalizationNode() {
  status_timer_.stop();
  diagnostics_timer_.stop();
  for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  for (ros::ServiceServer& service : services_) service.shutdown();
  reload_spinner_.stop();  // while the threads that it waits for still run
  map_builder_.stop();
  worker_.stop();
  if (parameters_.last_pose_file.empty()) return;
  if (const std::optional<SavedPose> pose = lastPose()) writeLastPose(*pose);
}

void LocalizationNode::onInitialPose(
    const geometry_msgs::PoseWithCovarianceStampedConstPtr& message) {
  const std::string frame = stripLeadingSlash(message->header.frame_id);
  try {
    if (frame != parameters_.map_frame) {
      throw MessageError("the frame is '" + printable(frame) + "'; expected '" +
                         parameters_.map_frame + "'");
    }
    const PoseEstimate pose = toPoseEstimate(message->pose);
    worker_.post([this, pose, stamp = message->header.stamp] { start(pose, stamp); });
  } catch (const MessageError& error) {
    reportRejection(&NodeStatus::starts_rejected, "initialpose rejected", error.what());
  }
}

void LocalizationNode::onClickedPoint(const geometry_msgs::PointStampedConstPtr&) {
  worker_.post([this] { startGlobally(); });
}

bool LocalizationNode::onGlobalLocalization(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  worker_.post([this] { startGlobally(); });
  return true;
}

bool LocalizationNode::onNoMotionUpdate(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  worker_.post([this] { localizer_.requestUpdate(); });
  return true;
}

void LocalizationNode::start(const PoseEstimate& pose, const ros::Time& stamp) {
  try {
    localizer_.initialize(pose, stamp.toSec());
  } catch (const std::exception& error) {
    reportRejection(&NodeStatus::starts_rejected, "start rejected", error.what());
    return;
  }
  updateNodeStatus();
  publishStatus();
  char text[128];
  std::snprintf(text, sizeof(text), "localizing from (%.3f m, %.3f m, %.3f rad)",
                pose.base_in_map.x, pose.base_in_map.y, pose.base_in_map.yaw);
  logEvent(text);
}

void LocalizationNode::startGlobally() {
  if (localizer_.initializeGlobally()) {
    updateNodeStatus();
    publishStatus();
    logEvent("localizing globally over the whole map");
  } else {
    reportRejection(&NodeStatus::starts_rejected, "global localization rejected",
                    "it requires a map");
  }
}

void LocalizationNode::warnThrottled(const std::string& subject, const std::string& reason) {
  racecar_mcl::warnThrottled(&log_throttle_, subject, reason);
}

void LocalizationNode::logEvent(const std::string& text) {
  if (log_throttle_.isDue()) ROS_INFO("%s", text.c_str());
}

void LocalizationNode::reportError(const std::string& what) {
  const std::string problem = "internal error: " + withoutControlCharacters(what);
  recordProblem(problem, &NodeStatus::errors);
  if (log_throttle_.isDue("internal error", problem)) ROS_ERROR("%s", problem.c_str());
}

void LocalizationNode::recordProblem(const std::string& problem,
                                     std::uint64_t NodeStatus::*counter) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (counter) ++(node_status_.*counter);
  node_status_.last_problem = withoutControlCharacters(problem);
}

void LocalizationNode::reportRejection(std::uint64_t NodeStatus::*counter,
                                       const std::string& subject, const std::string& reason) {
  warnThrottled(subject, reason);
  recordProblem(subject + ": " + reason, counter);
}

void LocalizationNode::onStatusTimer(const ros::WallTimerEvent&) {
  publishStatus();
  saveLastPose();
}

void LocalizationNode::onDiagnosticsTimer(const ros::WallTimerEvent&) {
  tf_queue_.callAvailable();
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  NodeStatus status;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    node_status_.started = localizer_.initialized();
    static_cast<OdometryCounters&>(node_status_.counters) = localizer_.odometryCounters();
    node_status_.latency_p50 = latency_.quantile(0.5);
    node_status_.latency_p99 = latency_.quantile(0.99);
    node_status_.lidars = lidars_.lidars();
    status = node_status_;
  }
  array.status.push_back(toDiagnostics(status, diagnosticsName(name_)));
  diagnostics_publisher_.publish(array);
}

}  // namespace racecar_mcl
