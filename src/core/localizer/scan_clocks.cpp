#include "racecar_mcl/localizer/scan_clocks.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/limits.h"
#include "racecar_mcl/scan/scan.h"

namespace racecar_mcl {
namespace {

// A scan is an outlier if it is further ahead of the lidar's scans, in periods, and of odometry.
constexpr double kMaxScanPeriodsAhead = 1.5;
// The period of either before its second message.
constexpr double kUnknownPeriod = 0.2;  // s

// Odometry moves a scan to the stamp of another lidar's newer scan over at most this time: a lidar
// with 5 Hz whose scans arrive after those of a faster one.
constexpr double kMaxScanLag = 0.3;  // s

// Another lidar goes on if odometry is not further from its last scan: more than a period of 5 Hz.
constexpr double kMaxScanAge = 0.5;  // s

}  // namespace

double knownPeriod(double period) { return period > 0.0 ? period : kUnknownPeriod; }

ScanClocks::ScanClocks(double clock_jump)
    : clock_jump_(clock_jump), clocks_(kMaxLidars, {{}, ClockJumpDetector(clock_jump)}) {}

void ScanClocks::reset() { *this = ScanClocks(clock_jump_); }

void ScanClocks::recordUsed(double stamp, int lidar) {
  newest_ = evaluationStamp(stamp);
  clocks_.at(static_cast<std::size_t>(lidar)).last_used = stamp;
}

double ScanClocks::evaluationStamp(double stamp) const {
  return std::max(stamp, newest_.value_or(stamp));
}

bool ScanClocks::anotherGoesOn(int lidar, double now) const {
  for (int other = 0; other < kMaxLidars; ++other) {
    const std::optional<double>& used = clocks_[static_cast<std::size_t>(other)].last_used;
    if (other != lidar && used && std::abs(now - *used) <= kMaxScanAge) return true;
  }
  return false;
}

ScanOutcome ScanClocks::check(double stamp, int lidar, const std::optional<double>& max_stamp) {
  if (!isWithin(stamp, kMaxStamp)) return ScanOutcome::kNotFinite;
  ScanClock& clock = clocks_.at(static_cast<std::size_t>(lidar));
  std::optional<double> latest = max_stamp;
  if (const std::optional<double> scan = clock.clock_jump.newest()) {
    const double next = *scan + kMaxScanPeriodsAhead * knownPeriod(clock.clock_jump.period());
    latest = std::max(next, latest.value_or(next));
  }
  const bool may_jump = !(max_stamp && anotherGoesOn(lidar, *max_stamp));
  const StampCheck checked = clock.clock_jump.check(stamp, latest.value_or(stamp), may_jump);
  if (checked == StampCheck::kOutlier) return ScanOutcome::kStampOutlier;
  if (clock.last_used && stamp <= *clock.last_used) {
    if (stamp == *clock.last_used) return ScanOutcome::kRepeatedStamp;
    if (stamp > *clock.last_used - clock_jump_) return ScanOutcome::kOutOfOrder;
    const ClockJumpDetector of_lidar = clock.clock_jump;  // has accepted the new time
    reset();
    clocks_[static_cast<std::size_t>(lidar)].clock_jump = of_lidar;
    return ScanOutcome::kTimeJumpedBack;
  }
  return evaluationStamp(stamp) - stamp > kMaxScanLag ? ScanOutcome::kOutOfOrder
                                                      : ScanOutcome::kUsed;
}

}  // namespace racecar_mcl
