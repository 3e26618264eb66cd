// Numbers the lidars of a car by the frames of their scans.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "racecar_mcl/common/printable.h"
#include "racecar_mcl/scan/scan.h"
#include "ros/conversions/message_conversions.h"

namespace racecar_mcl {

/// A lidar that has taken scans, in this run or an earlier one.
struct RegisteredLidar {
  std::string frame;
  std::string topic;             ///< empty before its first scan
  std::uint64_t scans_used = 0;  ///< with an estimate
};

class LidarRegistry {
 public:
  static constexpr int kUnknown = -1;

  /// Scan::lidar of a frame, or kUnknown.
  int find(const std::string& frame) const {
    const auto lidar =
        std::find_if(lidars_.begin(), lidars_.end(),
                     [&](const RegisteredLidar& known) { return known.frame == frame; });
    return lidar == lidars_.end() ? kUnknown : static_cast<int>(lidar - lidars_.begin());
  }

  /// The same for a scan on `topic`; a new frame gets the next number. Throws MessageError if there
  /// are kMaxLidars, or if the frame is that of scans on another topic.
  int add(const std::string& frame, const std::string& topic) {
    if (find(frame) == kUnknown) {
      if (lidars_.size() == static_cast<std::size_t>(kMaxLidars)) {
        throw MessageError("'" + printable(frame) + "' is the frame of a ninth lidar; at most " +
                           std::to_string(kMaxLidars) + " are supported");
      }
      lidars_.push_back({frame, topic, 0});
    }
    const int lidar = find(frame);
    std::string& known_topic = lidars_[static_cast<std::size_t>(lidar)].topic;
    if (known_topic.empty()) known_topic = topic;
    if (stripLeadingSlash(known_topic) != stripLeadingSlash(topic)) {
      throw MessageError("scans on " + printable(known_topic) + " and on " + printable(topic) +
                         " have the frame '" + printable(frame) +
                         "'; expected a frame of its own for each lidar");
    }
    return lidar;
  }

  void countUsed(int lidar) { ++lidars_.at(static_cast<std::size_t>(lidar)).scans_used; }

  const RegisteredLidar& at(int lidar) const { return lidars_.at(static_cast<std::size_t>(lidar)); }
  const std::vector<RegisteredLidar>& lidars() const { return lidars_; }

 private:
  std::vector<RegisteredLidar> lidars_;  ///< by Scan::lidar
};

}  // namespace racecar_mcl
