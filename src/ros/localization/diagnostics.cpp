#include "ros/localization/diagnostics.h"

#include <algorithm>
#include <sstream>

namespace racecar_mcl {
namespace {

struct Summary {
  diagnostic_msgs::DiagnosticStatus::_level_type level;
  std::string message;
};

diagnostic_msgs::DiagnosticStatus::_level_type levelOf(LocalizationState state) {
  switch (state) {
    case LocalizationState::kLocalized:
      return diagnostic_msgs::DiagnosticStatus::OK;
    case LocalizationState::kLost:
      return diagnostic_msgs::DiagnosticStatus::ERROR;
    default:
      return diagnostic_msgs::DiagnosticStatus::WARN;
  }
}

template <typename Value>
void add(const std::string& key, const Value& value, diagnostic_msgs::DiagnosticStatus* message) {
  diagnostic_msgs::KeyValue pair;
  pair.key = key;
  std::ostringstream text;
  text << value;
  pair.value = text.str();
  message->values.push_back(pair);
}

void addStatus(const LocalizationStatus& status, diagnostic_msgs::DiagnosticStatus* message) {
  add("status", toString(status.state), message);
  add("reason", status.reason, message);
  add("inlier ratio (%)", 100.0 * status.inlier_ratio, message);
  add("baseline inlier ratio (%)", 100.0 * status.baseline_inlier_ratio, message);
  add("conflict with the map (%)", 100.0 * status.conflict, message);
  add("distance without map match (m)", status.carried, message);
  add("protection level along (m)", status.level.along, message);
  add("protection level across (m)", status.level.across, message);
  add("protection level heading (rad)", status.level.heading, message);
  add("localizability along (m)", status.localizability.along, message);
  add("localizability across (m)", status.localizability.across, message);
  add("localizability heading (rad)", status.localizability.heading, message);
  add("odometry disagreement (%)", 100.0 * status.disagreement, message);
}

void addLidar(const std::string& prefix, const RegisteredLidar& lidar,
              const LidarCalibration& calibration, diagnostic_msgs::DiagnosticStatus* message) {
  add(prefix + "lidar frame", lidar.frame, message);
  add(prefix + "lidar topic", lidar.topic, message);
  add(prefix + "lidar scans used", lidar.scans_used, message);
  add(prefix + "scan direction", scanDirectionName(calibration.scan_reversed), message);
  add(prefix + "range bias (m)", calibration.range_bias, message);
}

/// Each lidar of this run; the keys of several begin with their frames.
void addLidars(const NodeStatus& s, diagnostic_msgs::DiagnosticStatus* message) {
  const auto scans = [](const RegisteredLidar& lidar) { return !lidar.topic.empty(); };
  const auto scanning = std::count_if(s.lidars.begin(), s.lidars.end(), scans);
  if (scanning == 0) addLidar("", {}, {}, message);
  for (std::size_t i = 0; i < s.lidars.size(); ++i) {
    if (!scans(s.lidars[i])) continue;
    const bool is_calibrated = i < s.sensors.lidars.size();
    addLidar(scanning > 1 ? s.lidars[i].frame + ": " : "", s.lidars[i],
             is_calibrated ? s.sensors.lidars[i] : LidarCalibration{}, message);
  }
  add("silent lidars", s.silent_lidars, message);
}

Summary summarize(const NodeStatus& s) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  if (!s.has_map) return {Status::WARN, "waiting for a map"};
  if (!s.started) return {Status::WARN, "waiting for a start pose"};
  const auto level = levelOf(s.status.state);
  return {s.silent_lidars.empty() ? level : std::max(level, levelOf(LocalizationState::kDegraded)),
          toString(s.status.state) + ": " + s.status.reason};
}

}  // namespace

diagnostic_msgs::DiagnosticStatus toDiagnostics(const LocalizationStatus& status) {
  diagnostic_msgs::DiagnosticStatus message;
  message.level = levelOf(status.state);
  message.name = "status";
  message.hardware_id = "none";
  message.message = toString(status.state);
  addStatus(status, &message);
  return message;
}

diagnostic_msgs::DiagnosticStatus toDiagnostics(const NodeStatus& s, const std::string& name) {
  diagnostic_msgs::DiagnosticStatus message;
  message.name = name;
  message.hardware_id = "none";
  const Summary summary = summarize(s);
  message.level = summary.level;
  message.message = summary.message;
  addStatus(s.status, &message);
  const auto add = [&](const char* key, const auto& value) {
    racecar_mcl::add(key, value, &message);
  };
  add("clusters", s.clusters);
  add("recoveries", s.counters.recoveries);
  add("particles", s.particles);
  add("beams", s.beams);
  addLidars(s, &message);
  const OdometryErrors& odometry = s.sensors.odometry;
  add("distance scale", odometry.distance_scale);
  add("odometry delay (s)", odometry.delay);
  add("odometry turn scale", odometry.turn.scale);
  add("odometry turn delay (s)", odometry.turn.delay);
  add("gyro", toString(s.gyro.use()));
  add("gyro unit", s.gyro.isInDegrees() ? "degrees per second" : "rad/s");
  add("gyro scale", s.gyro.calibration().scale());
  add("gyro delay (s)", s.gyro.calibration().delay());
  add("effective sample size", s.effective_sample_size);
  add("position sigma (m)", s.position_sigma);
  add("yaw sigma (rad)", s.yaw_sigma);
  add("scan to tf p50 (ms)", 1e3 * s.latency_p50);
  add("scan to tf p99 (ms)", 1e3 * s.latency_p99);
  add("scans seen", s.counters.scans_seen);
  add("scans used", s.counters.scans_used);
  add("scans stationary", s.counters.scans_stationary);
  add("scans dropped", s.counters.scans_dropped);
  add("scans unreadable", s.scans_unreadable);
  add("scans without tf", s.scans_without_tf);
  add("scans superseded", s.scans_superseded);
  add("scans with vanished weights", s.counters.weights_vanished);
  add("odometry seen", s.counters.odometry_seen);
  add("odometry used", s.counters.odometry_used);
  add("odometry dropped", s.counters.odometry_dropped);
  add("odometry gaps", s.counters.odometry_gaps);
  add("gyro samples seen", s.counters.gyro_seen);
  add("gyro samples dropped", s.counters.gyro_dropped);
  add("time jumps", s.counters.time_jumps);
  add("stamps rejected", s.stamps_rejected);
  add("start poses rejected", s.starts_rejected);
  add("maps rejected", s.maps_rejected);
  add("internal errors", s.errors);
  add("scans aborted by an internal error", s.counters.scans_failed);
  add("last problem", s.last_problem);
  return message;
}

}  // namespace racecar_mcl
