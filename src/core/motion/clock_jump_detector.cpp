#include "racecar_mcl/motion/clock_jump_detector.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

constexpr double kDecay = 0.9;  // of the longest interval, per message

}  // namespace

StampCheck ClockJumpDetector::check(double stamp, double max_stamp, bool may_jump) {
  if (stamp <= max_stamp && !(newest_ && stamp <= *newest_ - max_back_)) {
    if (newest_) period_ = std::max(stamp - *newest_, kDecay * period_);
    newest_ = std::max(stamp, newest_.value_or(stamp));
    outlier_.reset();
    return StampCheck::kPlausible;
  }
  if (may_jump && followsOutlier(stamp, newest_.value_or(max_stamp))) {
    newest_ = stamp;
    outlier_.reset();
    return StampCheck::kClockJump;
  }
  outlier_ = stamp;
  return StampCheck::kOutlier;
}

/// A sensor whose period exceeds both is confirmed by every second stamp.
bool ClockJumpDetector::followsOutlier(double stamp, double newest) const {
  if (!outlier_) return false;
  const double jump = std::abs(*outlier_ - newest);
  return stamp > *outlier_ && stamp - *outlier_ <= std::max(max_back_, 2.0 * jump);
}

}  // namespace racecar_mcl
