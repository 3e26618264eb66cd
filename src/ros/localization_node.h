// The localizer on the ROS graph: subscribes, converts, hands over, publishes.
//
// Two threads meet here. ROS callbacks take odometry in and pass everything else on; the worker
// owns the particles and the map and does what takes long. They share the localizer's timeline
// (odometry, estimate, counters) under one mutex that nobody holds for long, so that odometry never
// waits for a scan.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/SetMap.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Empty.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "racecar_mcl/localizer.h"
#include "racecar_mcl/map_summary.h"
#include "racecar_mcl/silence.h"
#include "ros/conversions.h"
#include "ros/diagnostics.h"
#include "ros/laser_mounts.h"
#include "ros/latency_window.h"
#include "ros/latest_slot.h"
#include "ros/localization_output.h"
#include "ros/log_limiter.h"
#include "ros/node_parameters.h"
#include "ros/task_thread.h"
#include "ros/tf_odometry.h"
#include "ros/tf_parent_watch.h"

namespace racecar_mcl {

class LocalizationNode {
 public:
  /// Topics are relative to `node`, parameters to `private_node`. Throws ParameterError.
  LocalizationNode(ros::NodeHandle node, ros::NodeHandle private_node);
  ~LocalizationNode();

 private:
  struct ReceivedScan {
    sensor_msgs::LaserScanConstPtr message;
    ros::WallTime arrival;
  };

  // Callbacks; each only converts and passes on.
  void onOdometry(const nav_msgs::OdometryConstPtr& message);
  void onTransforms(const tf2_msgs::TFMessageConstPtr& message, bool is_static);
  void onScan(const sensor_msgs::LaserScanConstPtr& message);
  void onMap(const nav_msgs::OccupancyGridConstPtr& message);
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& message);
  void onClickedPoint(const geometry_msgs::PointStampedConstPtr& message);
  bool onGlobalLocalization(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool onNoMotionUpdate(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool onSetMap(nav_msgs::SetMap::Request& request, nav_msgs::SetMap::Response& response);
  void onVerdictTimer(const ros::WallTimerEvent&);
  void onDiagnosticsTimer(const ros::WallTimerEvent&);

  // The worker's tasks.
  void buildMap();
  void useMap(const std::shared_ptr<MapModel>& map, const MapSummary& summary);
  void processScan();
  void start(const PoseEstimate& pose);
  void startGlobally();
  void restartAfterTimeJump(double stamp);

  void subscribeOdometry();
  void checkOdometryFrames(const nav_msgs::Odometry& message, const OdometrySample& sample);
  std::optional<Scan> readScan(const sensor_msgs::LaserScan& message, LaserMount* mount);
  void waitForOdometry(double stamp);
  /// Takes the scan through the localizer. What goes wrong there costs this scan alone.
  ScanResult update(const Scan& scan);
  void publishPose(bool after_scan);
  void publishVerdict();
  void broadcast(const PoseEstimate& estimate, double stamp);
  void noteScan(const ScanResult& result, ros::WallTime arrival);
  void reportDropped(ScanOutcome outcome);
  bool isStampRefused(const std::string& what, const ros::Time& stamp);
  /// Says what the map is, and of its warnings those that the map before did not have.
  void report(const MapSummary& summary);
  /// Says what comes with every message now and then.
  void warn(const std::string& subject, const std::string& reason);
  /// Counts what went wrong, and keeps it for the diagnostics.
  void note(const std::string& problem, std::uint64_t NodeStatus::*counter = nullptr);
  /// Of a task that ended with an exception.
  void noteError(const std::string& what);
  /// Notes it and says it every time: somebody asked for it.
  void refuse(std::uint64_t NodeStatus::*counter, const std::string& problem);

  NodeParameters parameters_;
  ros::NodeHandle node_;
  std::string name_;

  std::mutex timeline_mutex_;  ///< guards the localizer's timeline and the fields up to `output_`
  std::condition_variable odometry_arrived_;
  Localizer localizer_;
  NodeStatus status_;
  LatencyWindow latency_;
  SilenceWatch silence_;  ///< by ROS time: a bag that is paused is not silent
  double last_published_stamp_ = 0.0;
  std::optional<double> newest_odometry_stamp_;
  std::string odometry_frame_;         ///< the frame that odometry says it moves
  std::optional<Pose2> base_in_odom_;  ///< as the newest odometry message gave it
  double base_in_odom_stamp_ = 0.0;

  LocalizationOutput output_;
  // tf comes with every pose, the node's own included. It waits here until it is needed, at a scan
  // and for the diagnostics: to be woken for each transform would cost more than to localize.
  ros::CallbackQueue tf_queue_;
  ros::NodeHandle tf_node_;
  LaserMounts laser_mounts_;
  TfParentWatch tf_parent_watch_;
  TfOdometry tf_odometry_;
  LogLimiter log_limiter_;

  LatestSlot<ReceivedScan> newest_scan_;
  LatestSlot<nav_msgs::OccupancyGridConstPtr> newest_map_;
  std::vector<std::string> map_warnings_;  ///< of the map in use; the worker's alone
  TaskThread map_builder_{[this](const std::string& what) { noteError(what); }};
  TaskThread worker_{[this](const std::string& what) { noteError(what); }};

  // Last, so that no callback finds a part missing.
  ros::Publisher diagnostics_publisher_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer verdict_timer_;
  ros::WallTimer diagnostics_timer_;
};

}  // namespace racecar_mcl
