// Says a thing when it is new and not again with every message. Unlike ROS_WARN_THROTTLE it is kept
// per node, may be asked from several threads, and also speaks while simulated time stands still.
#pragma once

#include <ros/time.h>

#include <map>
#include <mutex>
#include <string>

namespace racecar_mcl {

class LogLimiter {
 public:
  /// True when `text` about `subject` should be said now: the first time, after a second where the
  /// text is another, after ten where it is the same. Subjects are few and fixed.
  bool isDue(const std::string& subject, const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const ros::WallTime now = ros::WallTime::now();
    const auto [said, is_new] = said_.try_emplace(subject, Said{now, text});
    if (is_new) return true;
    const double elapsed = (now - said->second.when).toSec();
    if (elapsed < (said->second.text == text ? kSamePeriod : kOtherPeriod)) return false;
    said->second = {now, text};
    return true;
  }

  /// True the first time only.
  bool isFirst(const std::string& subject) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return said_.try_emplace(subject).second;
  }

 private:
  static constexpr double kSamePeriod = 10.0;  // s
  static constexpr double kOtherPeriod = 1.0;  // s

  struct Said {
    ros::WallTime when;
    std::string text;
  };

  std::mutex mutex_;
  std::map<std::string, Said> said_;
};

}  // namespace racecar_mcl
