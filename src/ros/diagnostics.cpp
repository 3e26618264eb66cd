#include "ros/diagnostics.h"

#include <sstream>

namespace racecar_mcl {
namespace {

struct Summary {
  diagnostic_msgs::DiagnosticStatus::_level_type level;
  std::string message;
};

diagnostic_msgs::DiagnosticStatus::_level_type levelOf(VerdictState state) {
  switch (state) {
    case VerdictState::kLocalized:
      return diagnostic_msgs::DiagnosticStatus::OK;
    case VerdictState::kLost:
      return diagnostic_msgs::DiagnosticStatus::ERROR;
    default:
      return diagnostic_msgs::DiagnosticStatus::WARN;
  }
}

template <typename Value>
void add(const char* key, const Value& value, diagnostic_msgs::DiagnosticStatus* message) {
  diagnostic_msgs::KeyValue pair;
  pair.key = key;
  std::ostringstream text;
  text << value;
  pair.value = text.str();
  message->values.push_back(pair);
}

void addVerdict(const Verdict& verdict, diagnostic_msgs::DiagnosticStatus* message) {
  add("verdict", describe(verdict.state), message);
  add("reason", verdict.reason, message);
  add("explained beams (%)", 100.0 * verdict.explained, message);
  add("usually explained (%)", 100.0 * verdict.usually, message);
  add("conflict with the map (%)", 100.0 * verdict.conflict, message);
  add("driven without the map (m)", verdict.carried, message);
  add("protection level along (m)", verdict.level.along, message);
  add("protection level across (m)", verdict.level.across, message);
  add("protection level heading (rad)", verdict.level.heading, message);
  add("odometry disagreement (%)", 100.0 * verdict.disagreement, message);
}

Summary summarize(const NodeStatus& s) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  if (!s.has_map) return {Status::WARN, "waiting for a map"};
  if (!s.started) return {Status::WARN, "waiting for a start pose"};
  return {levelOf(s.verdict.state), describe(s.verdict.state) + ": " + s.verdict.reason};
}

}  // namespace

diagnostic_msgs::DiagnosticStatus toDiagnostics(const Verdict& verdict) {
  diagnostic_msgs::DiagnosticStatus message;
  message.level = levelOf(verdict.state);
  message.name = "verdict";
  message.hardware_id = "none";
  message.message = describe(verdict.state);
  addVerdict(verdict, &message);
  return message;
}

diagnostic_msgs::DiagnosticStatus toDiagnostics(const NodeStatus& s, const std::string& name) {
  diagnostic_msgs::DiagnosticStatus message;
  message.name = name;
  message.hardware_id = "none";
  const Summary summary = summarize(s);
  message.level = summary.level;
  message.message = summary.message;
  addVerdict(s.verdict, &message);
  const auto add = [&](const char* key, const auto& value) {
    racecar_mcl::add(key, value, &message);
  };
  add("clusters", s.clusters);
  add("recoveries", s.counters.recoveries);
  add("particles", s.particles);
  add("beams", s.beams);
  add("sweep order", s.sweep_order);
  add("range bias (m)", s.range_bias);
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
  add("internal errors", s.errors);
  add("scans given up after an internal error", s.counters.scans_failed);
  add("last problem", s.last_problem);
  return message;
}

}  // namespace racecar_mcl
