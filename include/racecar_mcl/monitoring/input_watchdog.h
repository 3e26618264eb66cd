// Watchdog of the inputs: degrades the status when scans or odometry are missing.
#pragma once

#include <cstdio>
#include <map>
#include <optional>
#include <string>

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
  /// The same for a scan of the lidar with this name, of which further ones are expected.
  void recordScan(double now, const std::string& lidar) { scan_ = lidars_[lidar] = now; }
  /// Scans of a lidar with this name are expected from the next call of `monitor` on, or no longer.
  void expectLidar(const std::string& name) { lidars_[name]; }
  void forgetLidar(const std::string& name) { lidars_.erase(name); }
  /// An odometry message was used.
  void recordOdometry(double now) { odometry_ = now; }

  /// The status at this time. If an input has timed out, the reason states it, and kLocalized
  /// becomes kDegraded. If some lidars of several have, only the reason states it.
  LocalizationStatus monitor(LocalizationStatus status, double now) {
    const double scan = elapsed(&scan_, now);
    const double odometry = elapsed(&odometry_, now);
    const bool no_scan = scan > timeout_;
    std::string silence = findSilentLidars(now);
    if (no_scan) {  // all are silent
      silence.clear();
      silent_lidars_.clear();
    }
    if (no_scan || odometry > timeout_) {
      char reason[64];
      std::snprintf(reason, sizeof(reason), "no usable %s for %.1f s",
                    no_scan ? "scan" : "odometry", no_scan ? scan : odometry);
      status.reason = reason;
      if (status.state == LocalizationState::kLocalized) {
        status.state = LocalizationState::kDegraded;
      }
    }
    status.reason += silence;
    return status;
  }

  /// The names of lidars that have timed out at the last call of `monitor` while others go on,
  /// separated by commas; empty if none has.
  const std::string& silentLidars() const { return silent_lidars_; }

 private:
  /// Sets `silent_lidars_`. Returns the text of the reason; empty if none is silent.
  std::string findSilentLidars(double now) {
    silent_lidars_.clear();
    std::string text;
    for (auto& [name, last] : lidars_) {
      const double silence = elapsed(&last, now);
      if (silence <= timeout_) continue;
      char duration[32];
      std::snprintf(duration, sizeof(duration), " for %.1f s", silence);
      text += (text.empty() ? "; no usable scan of " : " and of ") + name + duration;
      silent_lidars_ += (silent_lidars_.empty() ? "" : ", ") + name;
    }
    return text;
  }

  /// Time since the last input, s. Restarts at `now` if there was no input yet, or if the clock has
  /// just started or was set back.
  static double elapsed(std::optional<double>* last, double now) {
    if (!*last || **last <= 0.0 || now < **last) *last = now;
    return now - **last;
  }

  double timeout_;
  std::optional<double> scan_, odometry_;
  std::map<std::string, std::optional<double>> lidars_;  ///< by name
  std::string silent_lidars_;
};

}  // namespace racecar_mcl
