// Records all outputs of the localization node and checks invariants, such as finite poses.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <tf2_msgs/TFMessage.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {

/// Callbacks run in the threads that process the handle's queue.
class LocalizationListener {
  template <typename Read>
  auto locked(const Read& read) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return read();
  }

 public:
  explicit LocalizationListener(ros::NodeHandle node)
      : namespace_(node.getNamespace()),
        log_subscriber_(node.subscribe("/rosout", 200, &LocalizationListener::onLog, this)),
        subscribers_{node.subscribe("pf/pose/odom", 200, &LocalizationListener::onPose, this,
                                    ros::TransportHints().tcpNoDelay()),
                     node.subscribe("amcl_pose", 200, &LocalizationListener::onAmclPose, this,
                                    ros::TransportHints().tcpNoDelay()),
                     node.subscribe("/diagnostics", 10, &LocalizationListener::onDiagnostics, this),
                     node.subscribe("/tf", 200, &LocalizationListener::onTransforms, this)} {}

  ~LocalizationListener() {
    for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
    log_subscriber_.shutdown();
  }

  std::vector<nav_msgs::Odometry> poses() const {
    return locked([this] { return poses_; });
  }
  std::size_t scanPoseCount() const {
    return locked([this] { return amcl_poses_.size(); });
  }
  std::optional<nav_msgs::Odometry> newestPose() const {
    return locked([this]() -> std::optional<nav_msgs::Odometry> {
      if (poses_.empty()) return std::nullopt;
      return poses_.back();
    });
  }
  /// Logged texts that contain `words`.
  int logged(const std::string& words) const {
    return locked([&] {
      int count = 0;
      for (const std::string& text : log_) count += text.find(words) != std::string::npos;
      return count;
    });
  }
  /// The newest value under a diagnostics key; empty before the first message.
  std::string diagnostic(const std::string& key) const {
    return locked([&] {
      for (const auto& pair : diagnostics_.values) {
        if (pair.key == key) return pair.value;
      }
      return std::string();
    });
  }
  diagnostic_msgs::DiagnosticStatus diagnostics() const {
    return locked([this] { return diagnostics_; });
  }
  std::vector<geometry_msgs::TransformStamped> transformsFrom(const std::string& parent) const {
    return locked([&] {
      std::vector<geometry_msgs::TransformStamped> found;
      for (const auto& transform : transforms_) {
        if (transform.header.frame_id == parent) found.push_back(transform);
      }
      return found;
    });
  }

  /// Waits until `holds` returns true; checked after each message.
  bool waitFor(const std::function<bool()>& holds, double seconds = 5.0) const {
    const auto end = std::chrono::steady_clock::now() +
                     std::chrono::microseconds(static_cast<std::int64_t>(1e6 * seconds));
    while (!holds()) {
      std::unique_lock<std::mutex> lock(mutex_);
      if (std::chrono::steady_clock::now() > end) return false;
      message_arrived_.wait_for(lock, std::chrono::milliseconds(5));
    }
    return true;
  }
  bool waitForLog(const std::string& words) const {
    return waitFor([&] { return logged(words) > 0; });
  }
  /// Waits until the logs of this many processes are connected; earlier log messages are lost.
  bool waitForLogOf(std::uint32_t processes) const {
    return waitFor([&] { return log_subscriber_.getNumPublishers() >= processes; });
  }
  bool waitForDiagnostic(const std::string& key, const std::string& value) const {
    return waitFor([&] { return diagnostic(key) == value; });
  }

  void forget() {
    const std::lock_guard<std::mutex> lock(mutex_);
    poses_.clear();
    amcl_poses_.clear();
    transforms_.clear();
    log_.clear();
    diagnostics_ = {};
  }

 private:
  template <typename Message>
  void keep(std::vector<Message>* list, const Message& message) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      list->push_back(message);
    }
    message_arrived_.notify_all();
  }

  static void expectSane(const geometry_msgs::PoseWithCovariance& pose) {
    EXPECT_NO_THROW(toPoseEstimate(pose)) << "a pose with NaN, inf or no orientation";
    for (const double cell : pose.covariance) EXPECT_TRUE(std::isfinite(cell));
    for (int axis = 0; axis < 6; ++axis) {
      EXPECT_GE(pose.covariance[static_cast<std::size_t>(7 * axis)], 0.0) << "axis " << axis;
    }
  }

  void onPose(const nav_msgs::Odometry& message) {
    expectSane(message.pose);
    EXPECT_TRUE(std::isfinite(message.twist.twist.linear.x));
    EXPECT_TRUE(std::isfinite(message.twist.twist.angular.z));
    keep(&poses_, message);
  }
  void onAmclPose(const geometry_msgs::PoseWithCovarianceStamped& message) {
    expectSane(message.pose);
    keep(&amcl_poses_, message);
  }
  void onLog(const rosgraph_msgs::Log& message) { keep(&log_, message.msg); }
  void onTransforms(const tf2_msgs::TFMessage& message) {
    for (const auto& transform : message.transforms) {
      EXPECT_TRUE(std::isfinite(transform.transform.translation.x));
      EXPECT_TRUE(std::isfinite(transform.transform.translation.y));
      EXPECT_NO_THROW(yawOf(transform.transform.rotation));
      keep(&transforms_, transform);
    }
  }
  void onDiagnostics(const diagnostic_msgs::DiagnosticArray& message) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      for (const auto& status : message.status) {
        if (status.name.rfind(namespace_, 0) == 0) diagnostics_ = status;
      }
    }
    message_arrived_.notify_all();
  }

  std::string namespace_;
  mutable std::mutex mutex_;
  mutable std::condition_variable message_arrived_;
  std::vector<nav_msgs::Odometry> poses_;
  std::vector<geometry_msgs::PoseWithCovarianceStamped> amcl_poses_;
  std::vector<geometry_msgs::TransformStamped> transforms_;
  std::vector<std::string> log_;
  diagnostic_msgs::DiagnosticStatus diagnostics_;
  ros::Subscriber log_subscriber_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace racecar_mcl
