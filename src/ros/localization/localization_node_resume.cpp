// Part of LocalizationNode: saves the last pose, and starts from it.
#include <cstdio>
#include <stdexcept>

#include "ros/localization/localization_node.h"

namespace racecar_mcl {
namespace {

constexpr double kSavePeriod = 1.0;  // s of wall time
// Scans that wait for the first odometry pose before the saved pose is used as it is.
constexpr int kMaxWaitingScans = 20;

}  // namespace

void LocalizationNode::readLastPose() {
  if (parameters_.last_pose_file.empty()) return;
  // A launch clears the parameter; only a node that was respawned finds it.
  const bool is_respawned = private_node_.hasParam(kStartedParameter);
  private_node_.setParam(kStartedParameter, true);
  if (!is_respawned && (parameters_.initial_pose || parameters_.global_start)) return;
  try {
    saved_pose_ = readPoseFile(parameters_.last_pose_file);
    if (!saved_pose_) return;
    for (const std::string& frame : saved_pose_->lidar_frames) lidars_.add(frame, "");
  } catch (const std::exception& error) {
    reportRejection(nullptr, "last pose not used", error.what());
    saved_pose_.reset();
  }
  if (saved_pose_ && !saved_pose_->calibration_problem.empty()) {
    reportRejection(nullptr, "last calibration not used",
                    "the calibration cannot be read from " + parameters_.last_pose_file + ": " +
                        saved_pose_->calibration_problem + "; the pose is used");
  }
}

void LocalizationNode::resume() {
  if (!saved_pose_ || !localizer_.hasMap()) return;
  if (localizer_.initialized()) return saved_pose_.reset();  // by another start
  const std::string map = mapIdentity(localizer_.map()->grid.geometry());
  if (map != saved_pose_->map) {
    reportRejection(nullptr, "last pose not used",
                    "the map of " + parameters_.last_pose_file + " has " + saved_pose_->map +
                        "; this one " + map);
    saved_pose_.reset();
    if (parameters_.initial_pose) start({*parameters_.initial_pose, Eigen::Matrix3d::Zero()});
    if (parameters_.global_start) startGlobally();
    return;
  }
  std::optional<OdometryPose> odometry;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (base_in_odom_) odometry = {base_in_odom_stamp_, *base_in_odom_};
  }
  if (!odometry && ++scans_before_resume_ < kMaxWaitingScans) return;
  ROS_INFO("continuing from the last pose in %s", parameters_.last_pose_file.c_str());
  // Which of several lidars an old file's calibration belongs to is not known.
  if (saved_pose_->lidar_frames.empty() && parameters_.scan_topics.size() > 1) {
    if (saved_pose_->sensors) saved_pose_->sensors->lidars.clear();
  }
  if (saved_pose_->sensors) localizer_.resumeCalibration(*saved_pose_->sensors);
  start(resumedPose(*saved_pose_, odometry));
  saved_pose_.reset();
}

std::optional<SavedPose> LocalizationNode::lastPose() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (node_status_.status.state != LocalizationState::kLocalized) return std::nullopt;
  SavedPose pose;
  pose.map = map_identity_;
  pose.sensors = node_status_.sensors;
  for (const RegisteredLidar& lidar : lidars_.lidars()) {
    pose.lidar_frames.push_back(lidar.scans_used > 0 ? lidar.frame : "");
  }
  if (base_in_odom_) pose.odometry = {base_in_odom_stamp_, *base_in_odom_};
  const std::optional<PoseEstimate> estimate = localizer_.estimateAt(
      base_in_odom_ ? base_in_odom_stamp_ : localizer_.newestStamp().value_or(0.0));
  if (!estimate) return std::nullopt;
  pose.base_in_map = estimate->base_in_map;
  return pose;
}

void LocalizationNode::saveLastPose() {
  if (parameters_.last_pose_file.empty()) return;
  const ros::WallTime now = ros::WallTime::now();
  if ((now - last_save_).toSec() < kSavePeriod) return;
  const std::optional<SavedPose> pose = lastPose();
  if (!pose) return;
  last_save_ = now;
  map_builder_.post([this, pose] { writeLastPose(*pose); });
}

bool LocalizationNode::onSavePose(std_srvs::Trigger::Request&,
                                  std_srvs::Trigger::Response& response) {
  try {
    const SavedPose pose = poseToSave();
    // On the thread of the periodic saves, as each of them writes the same draft.
    runOn(&map_builder_, [&] { writePoseFile(parameters_.last_pose_file, pose); });
    char text[128];
    std::snprintf(text, sizeof(text), "%.3f m, %.3f m, %.3f rad saved in ", pose.base_in_map.x,
                  pose.base_in_map.y, pose.base_in_map.yaw);
    response.message = text + parameters_.last_pose_file;
    response.success = true;
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    reportRejection(nullptr, "pose not saved", response.message);
  }
  return true;
}

SavedPose LocalizationNode::poseToSave() {
  if (parameters_.last_pose_file.empty()) {
    throw std::runtime_error("last_pose_file is not set; set it and restart the node");
  }
  if (const std::optional<SavedPose> pose = lastPose()) return *pose;
  const std::lock_guard<std::mutex> lock(mutex_);
  const LocalizationStatus& status = node_status_.status;
  throw std::runtime_error("the status is " + toString(status.state) +
                           (status.reason.empty() ? "" : ": " + status.reason) +
                           "; a pose is saved while the status is localized");
}

void LocalizationNode::writeLastPose(const SavedPose& pose) {
  try {
    writePoseFile(parameters_.last_pose_file, pose);
  } catch (const std::exception& error) {
    recordProblem(error.what());
    warnThrottled("last_pose_file", error.what());
  }
}

}  // namespace racecar_mcl
