#include "ros/diagnostics.h"

#include <sstream>

namespace racecar_mcl {
namespace {

// Silence after which an input counts as missing.
constexpr double kSilent = 2.0;  // s

struct Summary {
  diagnostic_msgs::DiagnosticStatus::_level_type level;
  std::string message;
};

Summary summarize(const NodeStatus& s) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  if (!s.has_map) return {Status::WARN, "waiting for a map"};
  if (!s.started) return {Status::WARN, "waiting for a start pose"};
  if (s.seconds_since_scan > kSilent) return {Status::WARN, "no scans"};
  if (s.seconds_since_odometry > kSilent) return {Status::WARN, "no odometry"};
  if (s.counters.scans_used == 0) return {Status::WARN, "no scan could be used yet"};
  return {Status::OK, "localizing"};
}

}  // namespace

diagnostic_msgs::DiagnosticStatus toDiagnostics(const NodeStatus& s, const std::string& name) {
  diagnostic_msgs::DiagnosticStatus message;
  message.name = name;
  message.hardware_id = "none";
  const Summary summary = summarize(s);
  message.level = summary.level;
  message.message = summary.message;
  const auto add = [&](const char* key, const auto& value) {
    diagnostic_msgs::KeyValue pair;
    pair.key = key;
    std::ostringstream text;
    text << value;
    pair.value = text.str();
    message.values.push_back(pair);
  };
  add("particles", s.particles);
  add("beams", s.beams);
  add("effective sample size", s.effective_sample_size);
  add("position sigma (m)", s.position_sigma);
  add("yaw sigma (rad)", s.yaw_sigma);
  add("scan to tf p50 (ms)", 1e3 * s.latency_p50);
  add("scan to tf p99 (ms)", 1e3 * s.latency_p99);
  add("scans seen", s.counters.scans_seen);
  add("scans used", s.counters.scans_used);
  add("scans parked", s.counters.scans_parked);
  add("scans dropped", s.counters.scans_dropped);
  add("scans unreadable", s.scans_unreadable);
  add("scans without tf", s.scans_without_tf);
  add("scans superseded", s.scans_superseded);
  add("scans no particle explains", s.counters.weights_vanished);
  add("odometry seen", s.counters.odometry_seen);
  add("odometry used", s.counters.odometry_used);
  add("odometry dropped", s.counters.odometry_dropped);
  add("odometry gaps", s.counters.odometry_gaps);
  add("time jumps", s.counters.time_jumps);
  add("stamps refused", s.stamps_refused);
  add("start poses refused", s.starts_refused);
  add("maps refused", s.maps_refused);
  add("last problem", s.last_problem);
  return message;
}

}  // namespace racecar_mcl
