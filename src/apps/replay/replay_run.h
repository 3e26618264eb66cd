// A recording driven through the localizer as fast as it goes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bag_reader.h"
#include "evaluation/trajectory.h"
#include "racecar_mcl/localizer.h"

namespace racecar_mcl {

/// A pose that holds at a stamp, not at the recording's beginning.
struct TimedStart {
  Nanoseconds stamp = 0;
  PoseEstimate estimate;
};

struct ReplayInput {
  std::string scan_topic;
  std::string odometry_topic;
  std::optional<TfFrames> odometry_from_tf;  ///< instead of from the topic
  LaserMount mount;
  std::optional<TimedStart> start;  ///< none where the localizer has been started already
};

/// A scan that left an estimate.
struct ScanRow {
  Nanoseconds stamp = 0;
  ScanResult result;
  double update_ms = 0.0;
};

struct ReplayRecord {
  Trajectory trajectory;       ///< at every odometry message and scan; a scan's estimate wins
  std::vector<ScanRow> scans;  ///< in the order in which the localizer took them
  std::size_t scans_seen = 0;
  std::size_t scans_refused = 0;  ///< of the seen, messages that are no usable scan
  std::string first_refusal;      ///< and why
  double duration = 0.0;          ///< s, of recorded time
  double wall_seconds = 0.0;      ///< s, that the run took
};

/// Looks on while a recording is replayed. The time it takes counts neither for the updates nor for
/// the run.
class ReplayObserver {
 public:
  virtual ~ReplayObserver() = default;
  /// A scan, with all its valid beams as they were taken, has left an estimate.
  virtual void onScan(const Scan& scan, const ScanRow& row, const Localizer& localizer) = 0;
  /// A message is done with: estimates can be had up to localizer.newestStamp().
  virtual void onMessage(const Localizer& localizer) = 0;
};

/// Feeds every scan and odometry message to the localizer in the order in which it was recorded.
/// `progress` is called once per message.
ReplayRecord runReplay(const BagReader& bags, const ReplayInput& input, Localizer* localizer,
                       const std::function<void()>& progress,
                       const std::vector<ReplayObserver*>& observers = {});

}  // namespace racecar_mcl
