// Throttles log messages. Unlike ROS_WARN_THROTTLE it is per node, thread-safe and uses wall time,
// so it also works while simulated time is paused.
#pragma once

#include <ros/console.h>
#include <ros/time.h>

#include <array>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {

/// Whatever is logged, at most kMaxLines lines are due in any second.
class LogThrottle {
 public:
  static constexpr std::size_t kMaxLines = 8;

  /// True if `text` about `subject` is due: the first time, after 1 s if the text has changed,
  /// after 10 s if it is the same. The set of subjects must be small and fixed.
  bool isDue(const std::string& subject, const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const ros::WallTime now = ros::WallTime::now();
    const auto last = last_logs_.find(subject);
    if (last != last_logs_.end()) {
      const double elapsed = (now - last->second.when).toSec();
      if (elapsed < (last->second.text == text ? kSamePeriod : kChangedPeriod)) return false;
    }
    if (!takeLine(now)) return false;
    last_logs_[subject] = {now, text};
    return true;
  }

  /// True if the first call with this subject was at least `seconds` ago.
  bool persists(const std::string& subject, double seconds) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const ros::WallTime now = ros::WallTime::now();
    return (now - first_calls_.try_emplace(subject, now).first->second).toSec() >= seconds;
  }

  /// True the first time only.
  bool isFirst(const std::string& subject) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (last_logs_.count(subject) > 0 || !takeLine(ros::WallTime::now())) return false;
    last_logs_[subject] = {};
    return true;
  }

  /// True if a line about an event, not a problem, is due: limited by kMaxLines only.
  bool isDue() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return takeLine(ros::WallTime::now());
  }

 private:
  static constexpr double kSamePeriod = 10.0;    // s
  static constexpr double kChangedPeriod = 1.0;  // s

  struct LastLog {
    ros::WallTime when;
    std::string text;
  };

  bool takeLine(ros::WallTime now) {
    ros::WallTime& oldest = newest_lines_[next_line_];
    if (!oldest.isZero() && (now - oldest).toSec() < 1.0) return false;
    oldest = now;
    next_line_ = (next_line_ + 1) % kMaxLines;
    return true;
  }

  std::mutex mutex_;
  std::map<std::string, LastLog> last_logs_;
  std::array<ros::WallTime, kMaxLines> newest_lines_ = {};
  std::size_t next_line_ = 0;
  std::map<std::string, ros::WallTime> first_calls_;  ///< of `persists`
};

/// Logs `subject: reason` if it is due; control characters are escaped.
inline void warnThrottled(LogThrottle* throttle, const std::string& subject,
                          const std::string& reason) {
  const std::string text = withoutControlCharacters(reason);
  if (throttle->isDue(subject, text)) ROS_WARN("%s: %s", subject.c_str(), text.c_str());
}

}  // namespace racecar_mcl
