// Part of LocalizationNode: processes scans and publishes poses and status.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "racecar_mcl/localizer/scan_queue.h"
#include "ros/localization/localization_node.h"

namespace racecar_mcl {
namespace {

// tf accepts one pose per stamp; a second one is predicted and stamped this much later.
constexpr double kStampStep = 1e-6;  // s

// At a start map, start pose and tf may arrive after the first scans: no warning so far.
constexpr double kStartupTime = 2.0;  // s

}  // namespace

int LocalizationNode::lidarOf(const ReceivedScan& received) {
  const std::string frame = stripLeadingSlash(received.message->header.frame_id);
  const std::lock_guard<std::mutex> lock(mutex_);
  const int known = lidars_.find(frame);
  const bool is_first = known == LidarRegistry::kUnknown || lidars_.at(known).topic.empty();
  const int lidar = lidars_.add(frame, received.topic);
  if (is_first) {  // from now on it is expected by its frame
    watchdog_.forgetLidar(received.topic);
    watchdog_.expectLidar(frame);
  }
  return lidar;
}

std::optional<Scan> LocalizationNode::readScan(const ReceivedScan& received,
                                               LidarExtrinsics* extrinsics) {
  const sensor_msgs::LaserScan& message = *received.message;
  std::string odometry_frame;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    odometry_frame = odometry_frame_;
  }
  std::uint64_t NodeStatus::*counter = &NodeStatus::scans_without_tf;
  tf_queue_.callAvailable();
  try {
    *extrinsics =
        lidar_extrinsics_.find(stripLeadingSlash(message.header.frame_id), odometry_frame);
    counter = &NodeStatus::scans_unreadable;
    Scan scan = toScan(message, *extrinsics, parameters_.localizer.scan.deskew);
    scan.lidar = lidarOf(received);
    return scan;
  } catch (const MessageError& error) {
    recordProblem(std::string("scan dropped: ") + error.what(), counter);
    const bool is_startup = counter == &NodeStatus::scans_without_tf &&
                            !log_throttle_.persists("scan without tf", kStartupTime);
    if (!is_startup) warnThrottled("scan dropped", error.what());
  }
  return std::nullopt;
}

std::optional<LocalizationNode::ReceivedScan> LocalizationNode::nextScan() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto covers = [this](double stamp) { return localizer_.odometryCovers(stamp); };
  odometry_arrived_.wait_for(lock, std::chrono::duration<double>(kMaxOdometryWait), [&] {
    return scan_queue_.isReady(ros::WallTime::now().toSec(), covers);
  });
  return scan_queue_.take();
}

ScanResult LocalizationNode::updateLocalizer(const Scan& scan) {
  try {
    ScanResult result = localizer_.update(scan);
    updateNodeStatus();
    return result;
  } catch (...) {
    updateNodeStatus();
    throw;
  }
}

void LocalizationNode::processScan() {
  const std::optional<ReceivedScan> received = nextScan();
  if (!received) return;
  LidarExtrinsics extrinsics;
  const std::optional<Scan> scan = readScan(*received, &extrinsics);
  if (!scan) return;

  resume();
  const ScanResult result = updateLocalizer(*scan);
  if (hasEstimate(result.outcome)) {
    const std::lock_guard<std::mutex> lock(mutex_);
    watchdog_.recordScan(ros::Time::now().toSec(), lidars_.at(scan->lidar).frame);
  }
  publishStatus();
  reportGyro();
  if (result.outcome == ScanOutcome::kTimeJumpedBack) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      last_published_stamp_ = 0.0;
    }
    restartAfterTimeJump(scan->stamp);
  }
  if (hasEstimate(result.outcome) && !clockProblem(result).empty()) {
    warnThrottled("scan", clockProblem(result));
  }
  if (result.outcome == ScanOutcome::kWeightsVanished || !hasEstimate(result.outcome)) {
    reportUnused(result.outcome);
  }
  if (!hasEstimate(result.outcome)) return;
  publishPose(true);
  recordScan(result, scan->lidar, received->arrival);
  publisher_.publishScanTopics(localizer_.particles(), *localizer_.map(), *received->message,
                               extrinsics, result.update);
  obstacle_publisher_.publish(localizer_, *scan, received->message->header.stamp, result);
}

void LocalizationNode::updateNodeStatus() {
  const std::lock_guard<std::mutex> lock(mutex_);
  status_ = localizer_.status();
  node_status_.has_map = localizer_.hasMap();
  node_status_.counters = localizer_.counters();
  node_status_.sensors = localizer_.sensorCalibration();
  node_status_.gyro = localizer_.calibration().gyro();
}

void LocalizationNode::recordScan(const ScanResult& result, int lidar, ros::WallTime arrival) {
  const PoseEstimate& estimate = result.update.estimate;
  const std::lock_guard<std::mutex> lock(mutex_);
  latency_.add((ros::WallTime::now() - arrival).toSec());
  lidars_.countUsed(lidar);
  node_status_.position_sigma = positionSigma(estimate);
  node_status_.yaw_sigma = std::sqrt(std::max(0.0, estimate.covariance(2, 2)));
  if (result.outcome != ScanOutcome::kUsed) return;
  node_status_.effective_sample_size = result.update.effective_sample_size;
  node_status_.particles = result.update.particles;
  node_status_.beams = result.update.beams;
  node_status_.clusters = static_cast<int>(result.update.clusters.size());
}

void LocalizationNode::reportUnused(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kNoMap:
      if (log_throttle_.persists("waiting for a map", kStartupTime) &&
          log_throttle_.isFirst("no map")) {
        ROS_WARN("waiting for a map on %s", node_.resolveName("map").c_str());
      }
      break;
    case ScanOutcome::kNoStart:
      if (log_throttle_.persists("waiting for a start", kStartupTime) &&
          log_throttle_.isFirst("no start")) {
        ROS_WARN(
            "waiting for a start pose: set it in rviz with '2D Pose Estimate', click a point "
            "with 'Publish Point' to localize globally, or set initial_pose or global_start");
      }
      break;
    case ScanOutcome::kStampOutlier:
      // A single one is usual while nodes start: the first odometry arrives late.
      if (!log_throttle_.persists("stamp outlier", kStartupTime)) break;
      [[fallthrough]];
    default:
      warnThrottled("scan not used", toString(outcome));
  }
  recordProblem(toString(outcome));
}

void LocalizationNode::publishPose(bool after_scan) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::optional<double> newest = localizer_.newestStamp();
  if (!newest) return;
  double stamp = *newest;
  if (stamp <= last_published_stamp_) {
    // A published stamp is only published again after a scan has corrected the pose.
    if (!after_scan) return;
    stamp = last_published_stamp_ + kStampStep;
  }
  const std::optional<PoseEstimate> estimate = localizer_.estimateAt(stamp);
  if (!estimate) return;
  last_published_stamp_ = stamp;
  broadcast(*estimate, stamp);
  publisher_.publishPose(*estimate, localizer_.twist(), stamp, after_scan);
}

void LocalizationNode::publishStatus() {
  std::optional<StatusLog::Message> message;
  std::string silent_lidars;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::optional<PoseEstimate> estimate =
        localizer_.estimateAt(localizer_.newestStamp().value_or(0.0));
    if (!estimate) return;  // not started
    const ros::Time now = ros::Time::now();
    node_status_.status = watchdog_.monitor(status_, now.toSec());
    silent_lidars = node_status_.silent_lidars = watchdog_.silentLidars();
    publisher_.publishStatus(node_status_.status, estimate->base_in_map);
    message = status_log_.update(node_status_.status, now.toSec());
  }
  if (!silent_lidars.empty()) warnThrottled("lidar", "no usable scan of " + silent_lidars);
  if (!message) return;
  ROS_LOG(message->is_warning ? ros::console::levels::Warn : ros::console::levels::Info,
          ROSCONSOLE_DEFAULT_NAME, "%s", message->text.c_str());
}

void LocalizationNode::broadcast(const PoseEstimate& estimate, double stamp) {
  switch (parameters_.tf_mode) {
    case TfMode::kOff:
      return;
    case TfMode::kMapToBase: {
      // Predicted with the newest twist to the stamp it gets.
      const Pose2 base_ahead = compose(
          estimate.base_in_map, integrate(localizer_.twist(), parameters_.transform_tolerance));
      publisher_.broadcast(parameters_.particle_filter_frame, base_ahead, stamp);
      return;
    }
    case TfMode::kMapToOdom: {
      const std::optional<PoseEstimate> then = localizer_.estimateAt(base_in_odom_stamp_);
      if (!base_in_odom_ || !then) return;
      publisher_.broadcast(parameters_.odom_frame,
                           compose(then->base_in_map, inverse(*base_in_odom_)), stamp);
      return;
    }
  }
}

}  // namespace racecar_mcl
