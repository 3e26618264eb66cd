// The node's state in words (REP-107).
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <cstdint>
#include <string>

#include "racecar_mcl/localizer.h"

namespace racecar_mcl {

/// A snapshot of everything worth reporting.
struct NodeStatus {
  bool has_map = false;
  bool started = false;
  LocalizerCounters counters;
  Verdict verdict;                     ///< on the estimate
  int clusters = 0;                    ///< places where particles are
  std::uint64_t scans_unreadable = 0;  ///< messages that no conversion accepted
  std::uint64_t scans_without_tf = 0;  ///< no transform from the scan's frame to the car
  std::uint64_t scans_superseded = 0;  ///< a newer scan came before its turn
  std::uint64_t stamps_refused = 0;    ///< scans and odometry without a stamp or far ahead
  std::uint64_t starts_refused = 0;    ///< start poses that could not be used
  std::uint64_t maps_refused = 0;      ///< maps that could not be used
  std::uint64_t errors = 0;            ///< tasks of the node that an exception ended
  std::string last_problem;            ///< the newest of the above in words
  double latency_p50 = 0.0;            ///< s, from a scan's arrival to its tf
  double latency_p99 = 0.0;            ///< s
  double effective_sample_size = 0.0;
  int particles = 0;
  int beams = 0;
  std::string sweep_order;      ///< "listed" or "reversed": in which order beams were taken
  double range_bias = 0.0;      ///< m, ranges measured less distances mapped
  double position_sigma = 0.0;  ///< m, the larger axis
  double yaw_sigma = 0.0;       ///< rad
};

/// The verdict alone: its level, its state as the message, and what led to it.
diagnostic_msgs::DiagnosticStatus toDiagnostics(const Verdict& verdict);

diagnostic_msgs::DiagnosticStatus toDiagnostics(const NodeStatus& status, const std::string& name);

}  // namespace racecar_mcl
