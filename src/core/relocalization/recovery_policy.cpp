#include "racecar_mcl/relocalization/recovery_policy.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

// Conflict above the baseline. On recordings whose map lacks a wing, a hundredth of the scans
// exceed it at the right pose, and more than half of them at a wrong pose.
constexpr double kMinConflict = 0.15;
// Minimum duration of a conflict before a search (docs/maths.md).
constexpr double kMinConflictTime = 0.2;  // s
constexpr int kMinConflictScans = 6;
// Pause after a rejected search, doubled each time (docs/maths.md).
constexpr double kMinPause = 0.5;   // s
constexpr double kMaxPause = 16.0;  // s

}  // namespace

void RecoveryPolicy::update(const Evidence& evidence) {
  if (!evidence.converged || evidence.conflict <= kMinConflict) {
    conflict_since_.reset();
    scans_in_conflict_ = 0;
    search_is_due_ = false;
    return;
  }
  // A start in the future is from before the clock was set back.
  if (!conflict_since_ || *conflict_since_ > evidence.stamp) conflict_since_ = evidence.stamp;
  ++scans_in_conflict_;
  search_is_due_ = evidence.stamp - *conflict_since_ >= kMinConflictTime &&
                   scans_in_conflict_ >= kMinConflictScans &&
                   std::abs(evidence.stamp - last_rejected_) >= pause_;
}

void RecoveryPolicy::onRejected(double stamp) {
  last_rejected_ = stamp;
  pause_ = std::clamp(2.0 * pause_, kMinPause, kMaxPause);
}

void RecoveryPolicy::reset() { *this = RecoveryPolicy(); }

}  // namespace racecar_mcl
