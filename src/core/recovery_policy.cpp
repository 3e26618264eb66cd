#include "racecar_mcl/recovery_policy.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

// Beyond what is usual. The right pose is in such conflict with a hundredth of the scans of
// recordings whose map lacks a wing, the wrong one with more than half of them.
constexpr double kConflict = 0.15;
constexpr double kConflictTime = 0.2;  // s
constexpr int kConflictScans = 6;
constexpr double kShortestPause = 0.5;  // s
constexpr double kLongestPause = 16.0;  // s

}  // namespace

bool RecoveryPolicy::update(const Evidence& evidence) {
  if (!evidence.settled || evidence.conflict <= kConflict) {
    conflict_since_.reset();
    scans_in_conflict_ = 0;
    return false;
  }
  // A conflict that began later than now began in a time that the clock has left.
  if (!conflict_since_ || *conflict_since_ > evidence.stamp) conflict_since_ = evidence.stamp;
  ++scans_in_conflict_;
  return evidence.stamp - *conflict_since_ >= kConflictTime &&
         scans_in_conflict_ >= kConflictScans &&
         std::abs(evidence.stamp - last_rejected_) >= pause_;
}

void RecoveryPolicy::onRejected(double stamp) {
  last_rejected_ = stamp;
  pause_ = std::clamp(2.0 * pause_, kShortestPause, kLongestPause);
}

void RecoveryPolicy::reset() { *this = RecoveryPolicy(); }

}  // namespace racecar_mcl
