// The part of the node that takes a scan through the filter and publishes the pose.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "racecar_mcl/scan_hold.h"
#include "ros/localization_node.h"

namespace racecar_mcl {
namespace {

// Odometry older than this against the scan is not worth waiting for.
constexpr double kOdometryStale = 0.5;  // s
// Two poses of one stamp cannot both enter tf; the second is stamped, and carried, this much later.
constexpr double kStampStep = 1e-6;  // s

}  // namespace

std::optional<Scan> LocalizationNode::readScan(const sensor_msgs::LaserScan& message,
                                               LaserMount* mount) {
  std::string odometry_frame;
  {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    odometry_frame = odometry_frame_;
  }
  std::uint64_t NodeStatus::*counter = &NodeStatus::scans_without_tf;
  tf_queue_.callAvailable();
  try {
    *mount = laser_mounts_.find(stripLeadingSlash(message.header.frame_id), odometry_frame);
    counter = &NodeStatus::scans_unreadable;
    return toScan(message, *mount);
  } catch (const MessageError& error) {
    note(std::string("scan dropped: ") + error.what(), counter);
    warn("scan dropped", error.what());
  }
  return std::nullopt;
}

void LocalizationNode::waitForOdometry(double stamp) {
  std::unique_lock<std::mutex> lock(timeline_mutex_);
  if (!newest_odometry_stamp_ || stamp - *newest_odometry_stamp_ > kOdometryStale) return;
  odometry_arrived_.wait_for(lock, std::chrono::duration<double>(kOdometryPatience),
                             [&] { return localizer_.odometryCovers(stamp); });
}

ScanResult LocalizationNode::update(const Scan& scan) {
  try {
    Localizer::ScanTask task;
    {
      const std::lock_guard<std::mutex> lock(timeline_mutex_);
      task = localizer_.prepareScan(scan);
    }
    localizer_.processScan(&task);
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    ScanResult result = localizer_.commitScan(task);
    if (leavesEstimate(result.outcome)) silence_.hearScan(ros::Time::now().toSec());
    return result;
  } catch (...) {
    const std::lock_guard<std::mutex> lock(timeline_mutex_);
    localizer_.abandonScan();
    throw;
  }
}

void LocalizationNode::processScan() {
  const std::optional<ReceivedScan> received = newest_scan_.take();
  if (!received) return;
  LaserMount mount;
  const std::optional<Scan> scan = readScan(*received->message, &mount);
  if (!scan) return;

  waitForOdometry(scan->stamp);
  const ScanResult result = update(*scan);
  publishVerdict();
  if (result.outcome == ScanOutcome::kTimeJumpedBack) restartAfterTimeJump(scan->stamp);
  if (result.outcome == ScanOutcome::kWeightsVanished || !leavesEstimate(result.outcome)) {
    reportDropped(result.outcome);
  }
  if (!leavesEstimate(result.outcome)) return;
  publishPose(true);
  noteScan(result, received->arrival);
  output_.publishScanTopics(localizer_.particles(), *localizer_.map(), *received->message, mount,
                            result.update);
}

void LocalizationNode::noteScan(const ScanResult& result, ros::WallTime arrival) {
  const PoseEstimate& estimate = result.update.estimate;
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  latency_.add((ros::WallTime::now() - arrival).toSec());
  status_.position_sigma = positionSigma(estimate);
  status_.yaw_sigma = std::sqrt(std::max(0.0, estimate.covariance(2, 2)));
  if (result.outcome != ScanOutcome::kUsed) return;
  status_.effective_sample_size = result.update.effective_sample_size;
  status_.particles = result.update.particles;
  status_.beams = result.update.beams;
  status_.clusters = static_cast<int>(result.update.clusters.size());
}

void LocalizationNode::reportDropped(ScanOutcome outcome) {
  switch (outcome) {
    case ScanOutcome::kNoMap:
      if (log_limiter_.isFirst("no map")) {
        ROS_WARN("scans and odometry wait for a map on %s", node_.resolveName("map").c_str());
      }
      break;
    case ScanOutcome::kNoStart:
      if (log_limiter_.isFirst("no start")) {
        ROS_WARN(
            "scans wait for a start pose: set it in rviz with '2D Pose Estimate', click a point "
            "with 'Publish Point' to localize globally, or set initial_pose or global_start");
      }
      break;
    default:
      warn("scan not used", describe(outcome));
  }
  note(describe(outcome));
}

void LocalizationNode::publishPose(bool after_scan) {
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  const std::optional<double> newest = localizer_.newestStamp();
  if (!newest) return;
  double stamp = *newest;
  if (stamp <= last_published_stamp_) {
    // Odometry adds nothing to a stamp that is out; a scan's correction does.
    if (!after_scan) return;
    stamp = last_published_stamp_ + kStampStep;
  }
  const std::optional<PoseEstimate> estimate = localizer_.estimateAt(stamp);
  if (!estimate) return;
  last_published_stamp_ = stamp;
  broadcast(*estimate, stamp);
  output_.publishPose(*estimate, localizer_.twist(), stamp, after_scan);
}

void LocalizationNode::publishVerdict() {
  const std::lock_guard<std::mutex> lock(timeline_mutex_);
  if (!localizer_.initialized()) return;
  status_.verdict = silence_.judge(localizer_.verdict(), ros::Time::now().toSec());
  output_.publishVerdict(status_.verdict);
}

void LocalizationNode::broadcast(const PoseEstimate& estimate, double stamp) {
  switch (parameters_.tf_mode) {
    case TfMode::kOff:
      return;
    case TfMode::kMapToBase: {
      // Stamped ahead, and truthfully so: predicted to that time by the newest odometry.
      const Pose2 base_ahead = compose(
          estimate.base_in_map, integrate(localizer_.twist(), parameters_.transform_tolerance));
      output_.broadcast(parameters_.particle_filter_frame, base_ahead, stamp);
      return;
    }
    case TfMode::kMapToOdom: {
      const std::optional<PoseEstimate> then = localizer_.estimateAt(base_in_odom_stamp_);
      if (!base_in_odom_ || !then) return;
      output_.broadcast(parameters_.odom_frame, compose(then->base_in_map, inverse(*base_in_odom_)),
                        stamp);
      return;
    }
  }
}

}  // namespace racecar_mcl
