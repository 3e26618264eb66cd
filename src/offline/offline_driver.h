// Replays a recording through the localizer as fast as possible.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory.h"
#include "offline/bag_reader.h"
#include "racecar_mcl/localizer/localizer.h"
#include "ros/localization/lidar_registry.h"

namespace racecar_mcl {

/// A start pose and the stamp at which it is valid.
struct TimedStart {
  Nanoseconds stamp = 0;
  PoseEstimate estimate;
};

struct ReplayInput {
  std::vector<std::string> scan_topics;
  std::string odometry_topic;
  std::string imu_topic = {};                ///< empty: no gyro
  geometry_msgs::Quaternion imu_rotation;    ///< of the IMU in the base frame
  std::optional<TfFrames> odometry_from_tf;  ///< instead of from the topic
  /// Of the lidar with a frame; called for each scan. Throws std::runtime_error if they are
  /// unknown, and is then not called again for the frame.
  std::function<LidarExtrinsics(const std::string& frame)> extrinsics_of;
  std::optional<TimedStart> start;  ///< empty if the localizer is already initialized
};

/// A scan with an estimate.
struct ScanRow {
  Nanoseconds stamp = 0;  ///< of the estimate; another lidar's scan may be newer than this one
  int lidar = 0;          ///< Scan::lidar
  ScanResult result;
  double update_ms = 0.0;
};

struct ReplayRecord {
  Trajectory trajectory;       ///< at every odometry message and scan; scans take precedence
  std::vector<ScanRow> scans;  ///< in the order of processing
  std::vector<RegisteredLidar> lidars;  ///< by Scan::lidar
  std::size_t scans_seen = 0;
  std::map<std::string, std::size_t> dropped;  ///< numbers of messages by reason, for logs
  std::string clock_problem;                   ///< see clockProblem; empty if there was none
  std::string imu_rejection;  ///< reason of the first IMU message that cannot be converted
  double duration = 0.0;      ///< recorded time, s
  double wall_seconds = 0.0;  ///< processing time without observers, s
};

/// Receives every estimate during a replay. Its time is excluded from update and processing times.
class ReplayObserver {
 public:
  virtual ~ReplayObserver() = default;
  /// Called after a scan with an estimate; `scan` has all valid beams, not deskewed.
  virtual void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) = 0;
  /// Called after each message: estimates are available up to localizer.newestStamp().
  virtual void onMessage(const Localizer& localizer) = 0;
};

/// Feeds every scan and odometry message to the localizer in the order in which it was recorded.
/// `progress` is called once per message.
ReplayRecord runReplay(const BagReader& bags, const ReplayInput& input, Localizer* localizer,
                       const std::function<void()>& progress,
                       const std::vector<ReplayObserver*>& observers = {});

}  // namespace racecar_mcl
