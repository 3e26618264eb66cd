// An estimate that scans or odometry no longer support is not to be trusted, however good it was.
#pragma once

#include <cstdio>
#include <optional>

#include "racecar_mcl/verdict.h"

namespace racecar_mcl {

/// Knows when the inputs were last heard. `now` is any clock that the driver keeps, in s; while it
/// shows 0 it has not started, as simulated time before its first message.
class SilenceWatch {
 public:
  /// `longest`: s, that an input may be silent.
  explicit SilenceWatch(double longest) : longest_(longest) {}

  /// A scan that was held against the map.
  void hearScan(double now) { scan_ = now; }
  /// Odometry that was taken in.
  void hearOdometry(double now) { odometry_ = now; }

  /// The verdict as it is now. Where an input has been silent for too long, that is the reason, and
  /// what was localized is degraded.
  Verdict judge(Verdict verdict, double now) {
    const double scan = silence(&scan_, now);
    const double odometry = silence(&odometry_, now);
    const bool no_scan = scan > longest_;
    if (!no_scan && odometry <= longest_) return verdict;
    char reason[64];
    std::snprintf(reason, sizeof(reason), "no usable %s for %.1f s", no_scan ? "scan" : "odometry",
                  no_scan ? scan : odometry);
    verdict.reason = reason;
    if (verdict.state == VerdictState::kLocalized) verdict.state = VerdictState::kDegraded;
    return verdict;
  }

 private:
  /// Counts from now where nothing was heard before, the clock has just started or was set back.
  static double silence(std::optional<double>* heard, double now) {
    if (!*heard || **heard <= 0.0 || now < **heard) *heard = now;
    return now - **heard;
  }

  double longest_;
  std::optional<double> scan_, odometry_;
};

}  // namespace racecar_mcl
