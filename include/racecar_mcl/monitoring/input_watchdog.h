// Watchdog of the inputs: degrades the status when scans or odometry are missing.
#pragma once

#include <cstdio>
#include <optional>

#include "racecar_mcl/monitoring/localization_monitor.h"

namespace racecar_mcl {

/// Measures the time since the last usable inputs. `now` is the time on any clock, s; 0 means that
/// the clock has not started, as simulated time before its first message.
class InputWatchdog {
 public:
  /// `timeout`: s without an input after which the status is degraded.
  explicit InputWatchdog(double timeout) : timeout_(timeout) {}

  void setTimeout(double timeout) { timeout_ = timeout; }

  /// A scan was compared with the map.
  void recordScan(double now) { scan_ = now; }
  /// An odometry message was used.
  void recordOdometry(double now) { odometry_ = now; }

  /// The status at this time. If an input has timed out, the reason states it, and kLocalized
  /// becomes kDegraded.
  LocalizationStatus monitor(LocalizationStatus status, double now) {
    const double scan = elapsed(&scan_, now);
    const double odometry = elapsed(&odometry_, now);
    const bool no_scan = scan > timeout_;
    if (!no_scan && odometry <= timeout_) return status;
    char reason[64];
    std::snprintf(reason, sizeof(reason), "no usable %s for %.1f s", no_scan ? "scan" : "odometry",
                  no_scan ? scan : odometry);
    status.reason = reason;
    if (status.state == LocalizationState::kLocalized) status.state = LocalizationState::kDegraded;
    return status;
  }

 private:
  /// Time since the last input, s. Restarts at `now` if there was no input yet, or if the clock has
  /// just started or was set back.
  static double elapsed(std::optional<double>* last, double now) {
    if (!*last || **last <= 0.0 || now < **last) *last = now;
    return now - **last;
  }

  double timeout_;
  std::optional<double> scan_, odometry_;
};

}  // namespace racecar_mcl
