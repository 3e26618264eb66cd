// Checks the stamps of the scans of all lidars.
#pragma once

#include <optional>
#include <vector>

#include "racecar_mcl/localizer/scan_result.h"
#include "racecar_mcl/motion/clock_jump_detector.h"

namespace racecar_mcl {

/// The period of scans or odometry (s), or its assumption before the second message.
double knownPeriod(double period);

class ScanClocks {
 public:
  /// `clock_jump`: s, as in OdometryParameters.
  explicit ScanClocks(double clock_jump);

  /// kUsed if the stamp is newer than that of the lidar's last used scan, and not much older than
  /// that of another lidar. A second stamp that is older by clock_jump or more restarts the time of
  /// all lidars; one alone is an outlier, as is one far ahead of the lidar's scans and
  /// `max_stamp` (s, by odometry). A clock that jumps while another lidar and the odometry go on is
  /// wrong, and its scans remain outliers.
  ScanOutcome check(double stamp, int lidar, const std::optional<double>& max_stamp);
  void recordUsed(double stamp, int lidar);
  /// Accepts any next stamps.
  void reset();

  double clockJump() const { return clock_jump_; }  ///< s
  /// The newest stamp of a used scan.
  std::optional<double> newest() const { return newest_; }
  /// s, the time at which a scan is evaluated: its own stamp or, if a newer scan of another lidar
  /// was used before, the stamp of that scan.
  double evaluationStamp(double stamp) const;

 private:
  struct ScanClock {
    std::optional<double> last_used;  ///< s
    ClockJumpDetector clock_jump;
  };

  /// Whether the last used scan of another lidar is near `now`, s.
  bool anotherGoesOn(int lidar, double now) const;

  double clock_jump_;
  std::vector<ScanClock> clocks_;  ///< by Scan::lidar
  std::optional<double> newest_;   ///< s
};

}  // namespace racecar_mcl
