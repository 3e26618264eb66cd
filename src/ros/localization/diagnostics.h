// Diagnostics of the localization node (REP-107).
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cstdint>
#include <string>
#include <vector>

#include "racecar_mcl/localizer/localizer.h"
#include "ros/localization/lidar_registry.h"

namespace racecar_mcl {

/// A snapshot of the reported values.
struct NodeStatus {
  bool has_map = false;
  bool started = false;
  LocalizerCounters counters;
  LocalizationStatus status;           ///< on the estimate
  int clusters = 0;                    ///< number of particle clusters
  std::uint64_t scans_unreadable = 0;  ///< messages that cannot be converted
  std::uint64_t scans_without_tf = 0;  ///< no transform from the scan's frame to the car
  std::uint64_t scans_superseded = 0;  ///< replaced in the queue by a newer scan
  std::uint64_t stamps_rejected = 0;   ///< scans and odometry with a zero or future stamp
  std::uint64_t starts_rejected = 0;   ///< invalid start poses
  std::uint64_t maps_rejected = 0;     ///< invalid maps
  std::uint64_t errors = 0;            ///< tasks that ended with an exception
  std::string last_problem;            ///< description of the newest problem
  double latency_p50 = 0.0;            ///< s, from the arrival of a scan to its tf
  double latency_p99 = 0.0;            ///< s
  double effective_sample_size = 0.0;
  int particles = 0;
  int beams = 0;
  SensorCalibration sensors;
  std::vector<RegisteredLidar> lidars;  ///< by Scan::lidar
  std::string silent_lidars;            ///< InputWatchdog::silentLidars
  GyroCalibration gyro{0.0};
  double position_sigma = 0.0;  ///< m, the larger axis
  double yaw_sigma = 0.0;       ///< rad
};

/// The name of the entry in `/diagnostics` of a node such as "/localization".
inline std::string diagnosticsName(const std::string& node) { return node + ": localization"; }

/// The localization status alone: level, state as the message, and its inputs.
diagnostic_msgs::DiagnosticStatus toDiagnostics(const LocalizationStatus& status);

diagnostic_msgs::DiagnosticStatus toDiagnostics(const NodeStatus& node_status,
                                                const std::string& name);

}  // namespace racecar_mcl
