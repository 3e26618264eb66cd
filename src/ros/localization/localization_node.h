// ROS node of the localizer: converts messages, runs the localizer and publishes its results.
//
// ROS callbacks add odometry to the localizer and post all other work to the worker thread, which
// owns the localizer. Odometry never waits for a scan update: the localizer's PoseExtrapolator has
// a lock of its own.
#pragma once

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/SetMap.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/localizer/scan_queue.h"
#include "racecar_mcl/map/map_summary.h"
#include "racecar_mcl/monitoring/input_watchdog.h"
#include "ros/conversions/message_conversions.h"
#include "ros/localization/diagnostics.h"
#include "ros/localization/imu_rotation.h"
#include "ros/localization/lidar_extrinsics.h"
#include "ros/localization/lidar_registry.h"
#include "ros/localization/localization_publisher.h"
#include "ros/localization/node_parameters.h"
#include "ros/localization/obstacle_publisher.h"
#include "ros/localization/pose_file.h"
#include "ros/localization/status_log.h"
#ifdef RACECAR_MCL_HAS_DYNAMIC_RECONFIGURE
#include "ros/localization/reconfigure_server.h"
#endif
#include "ros/localization/tf_conflict_detector.h"
#include "ros/localization/tf_odometry.h"
#include "ros/util/latency_statistics.h"
#include "ros/util/log_throttle.h"
#include "ros/util/mailbox.h"
#include "ros/util/worker_thread.h"

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
    std::string topic;
  };

  // Callbacks: convert and post to the worker.
  void onOdometry(const nav_msgs::OdometryConstPtr& message);
  void onImu(const sensor_msgs::ImuConstPtr& message);
  void onTransforms(const tf2_msgs::TFMessageConstPtr& message, bool is_static);
  void onScan(const std::string& topic, const sensor_msgs::LaserScanConstPtr& message);
  void onMap(const nav_msgs::OccupancyGridConstPtr& message);
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& message);
  void onClickedPoint(const geometry_msgs::PointStampedConstPtr& message);
  bool onGlobalLocalization(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool onNoMotionUpdate(std_srvs::Empty::Request&, std_srvs::Empty::Response&);
  bool onSetMap(nav_msgs::SetMap::Request& request, nav_msgs::SetMap::Response& response);
  bool onReloadParameters(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool onSavePose(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  void advertisePrivateServices();
  void onStatusTimer(const ros::WallTimerEvent&);
  void onDiagnosticsTimer(const ros::WallTimerEvent&);

  // Tasks of the worker threads.
  void buildMap();
  void useMap(const std::shared_ptr<const LocalizationMap>& map);
  /// On the map builder: builds what the new parameters need, and switches between two scans.
  void changeParameters(const NodeParameters& parameters);
  void processScan();
  void start(const PoseEstimate& pose, const ros::Time& stamp = {});
  void startGlobally();
  void restartAfterTimeJump(double stamp);
  /// Starts from saved_pose_, as soon as the map and the odometry are there.
  void resume();

  void subscribeScans();
  void subscribeOdometry();
  void readLastPose();
  /// The pose to save; none unless localized.
  std::optional<SavedPose> lastPose();
  /// The same; throws std::runtime_error with the reason if there is none.
  SavedPose poseToSave();
  /// Writes it once per period, on the map builder.
  void saveLastPose();
  void writeLastPose(const SavedPose& pose);
  void checkOdometryFrames(const nav_msgs::Odometry& message, const OdometrySample& sample);
  std::optional<Scan> readScan(const ReceivedScan& received, LidarExtrinsics* extrinsics);
  /// Scan::lidar of a scan whose frame is on the car. Throws MessageError for a ninth lidar.
  int lidarOf(const ReceivedScan& received);
  /// Waits until odometry covers the newest scan or the maximum wait has elapsed.
  std::optional<ReceivedScan> nextScan();
  /// Also counts a scan that ends with an exception, which goes on to the worker.
  ScanResult updateLocalizer(const Scan& scan);
  void publishPose(bool after_scan);
  void publishStatus();
  void broadcast(const PoseEstimate& estimate, double stamp);
  /// Copies the localizer's state; call after every change by the worker.
  void updateNodeStatus();
  void recordScan(const ScanResult& result, int lidar, ros::WallTime arrival);
  void reportUnused(ScanOutcome outcome);
  /// Logs a change of the gyro's use.
  void reportGyro();
  bool hasInvalidStamp(const std::string& what, const ros::Time& stamp);
  /// Logs the map's summary, and its warnings unless the previous map had the same.
  void logSummary(const MapSummary& summary);
  /// Throttled warning; control characters are escaped.
  void warnThrottled(const std::string& subject, const std::string& reason);
  /// Throttled message about an event.
  void logEvent(const std::string& text);
  /// Counts a problem and keeps it for the diagnostics.
  void recordProblem(const std::string& problem, std::uint64_t NodeStatus::*counter = nullptr);
  /// Reports a task that ended with an exception.
  void reportError(const std::string& what);
  /// Records and logs a rejected request, such as `initialpose rejected`.
  void reportRejection(std::uint64_t NodeStatus::*counter, const std::string& subject,
                       const std::string& reason);

  /// changeParameters changes it on the worker, while the map builder waits, under mutex_; what
  /// callbacks read without that lock stays.
  NodeParameters parameters_;
  ros::NodeHandle node_, private_node_;
  std::string name_;

  std::mutex mutex_;  ///< guards the fields up to `publisher_`, except the localizer
  std::condition_variable odometry_arrived_;
  /// Used by the worker; methods that only use its PoseExtrapolator are thread-safe.
  Localizer localizer_;
  ScanQueue<ReceivedScan> scan_queue_{1};
  LidarRegistry lidars_;
  LocalizationStatus status_;  ///< of the newest estimate
  NodeStatus node_status_;
  LatencyStatistics latency_;
  StatusLog status_log_;
  InputWatchdog watchdog_;  ///< in ROS time: a paused bag causes no timeout
  double last_published_stamp_ = 0.0;
  std::string odometry_frame_;         ///< child frame of the newest odometry
  std::optional<Pose2> base_in_odom_;  ///< of the newest odometry message
  double base_in_odom_stamp_ = 0.0;
  std::string map_identity_;  ///< of the current map

  LocalizationPublisher publisher_;
  ObstaclePublisher obstacle_publisher_;  ///< used by the worker only
  // tf messages arrive with every pose, including the node's own. They are processed in batches, at
  // scans and diagnostics: waking up for each one would cost more than localizing.
  ros::CallbackQueue tf_queue_;
  ros::NodeHandle tf_node_;
  LidarExtrinsicsLookup lidar_extrinsics_;
  ImuRotation imu_rotation_;  ///< used by onImu only
  TfConflictDetector tf_conflict_detector_;
  TfOdometry tf_odometry_;
  LogThrottle log_throttle_;

  std::optional<SavedPose> saved_pose_;  ///< to start from; used by the worker only
  int scans_before_resume_ = 0;          ///< that waited for odometry; used by the worker only
  ros::WallTime last_save_;              ///< used by the status timer only

  Mailbox<nav_msgs::OccupancyGridConstPtr> newest_map_;
  std::vector<std::string> map_warnings_;  ///< of the current map; used by the worker only
  WorkerThread map_builder_{[this](const std::string& what) { reportError(what); }};
  WorkerThread worker_{[this](const std::string& what) { reportError(what); }};

  // Changes of parameters and save_pose wait for the threads above; callbacks of sensors must not.
  ros::CallbackQueue reload_queue_;
  ros::NodeHandle reload_node_;
  ros::AsyncSpinner reload_spinner_{1, &reload_queue_};

#ifdef RACECAR_MCL_HAS_DYNAMIC_RECONFIGURE
  std::unique_ptr<ReconfigureServer> reconfigure_server_;
#endif

  // Last, so that callbacks only start once all other members exist.
  ros::Publisher diagnostics_publisher_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer status_timer_;
  ros::WallTimer diagnostics_timer_;
};

}  // namespace racecar_mcl
