// Results and counters of the localizer.
#pragma once

#include <cstdint>
#include <string>

#include "racecar_mcl/filter/update_result.h"
#include "racecar_mcl/monitoring/localization_monitor.h"
#include "racecar_mcl/monitoring/scan_match.h"

namespace racecar_mcl {

enum class ScanOutcome {
  kUsed,
  kStationary,     ///< the car is stationary and stationary_updates scans were used: the estimate
                   ///< stays
  kNoMap,          ///< dropped: no map yet
  kNoStart,        ///< dropped: no start pose yet
  kNotFinite,      ///< dropped: stamp or lidar pose is not finite or beyond common/limits.h
  kRepeatedStamp,  ///< dropped
  kTooManyLidars,  ///< dropped: its index is not below kMaxLidars
  kOutOfOrder,    ///< dropped: older than the lidar's last scan, or over 0.3 s older than another's
  kStampOutlier,  ///< dropped: older by clock_jump or far ahead of scans and odometry, and the
                  ///< scan before was not; the next scan decides what it was
  kTooFewBeams,   ///< dropped: fewer than min_beams valid ones in the field of view
  kTimeJumpedBack,  ///< dropped: the clock was set back; the pose is kept and the next scan is
                    ///< used
  kWeightsVanished  ///< all likelihoods were zero: motion applied, weights kept
};

/// Text for logs and diagnostics.
std::string toString(ScanOutcome outcome);

/// Whether a scan with this outcome has an estimate at its stamp.
bool hasEstimate(ScanOutcome outcome);

/// Result of one scan.
struct ScanResult {
  ScanOutcome outcome = ScanOutcome::kNoMap;
  double stamp = 0.0;           ///< s, the scan's; of an estimate that of the newest scan: another
                                ///< lidar's may be newer
  LocalizationStatus status;    ///< of the last estimate, whether the scan was used or not
  ScanMatch match;              ///< at the estimate, if the outcome has one
  double range_bias = 0.0;      ///< m, subtracted from the ranges
  double distance_scale = 1.0;  ///< true metres per metre of odometry
  double turn_scale = 1.0;      ///< true radians per radian of odometry
  bool turned_by_gyro = false;  ///< the motion's turn is the gyro's
  double odometry_lag = 0.0;  ///< s, the scan's stamp minus that of the newest odometry; 0 if none
  UpdateResult update;  ///< set if the outcome is kUsed or kWeightsVanished; its estimate also if
                        ///< kStationary
};

/// A text for logs if scan and odometry are stamped over 1 s apart, as by different clocks; else
/// empty.
std::string clockProblem(const ScanResult& result);

/// Numbers of scans by outcome.
struct ScanCounters {
  std::uint64_t scans_seen = 0;
  std::uint64_t scans_used = 0;
  std::uint64_t scans_stationary = 0;
  std::uint64_t scans_dropped = 0;
  std::uint64_t weights_vanished = 0;
  std::uint64_t scans_failed = 0;  ///< dropped after an exception
  std::uint64_t recoveries = 0;    ///< searches that replaced the particles
};

/// Numbers of odometry messages and gyro samples by outcome.
struct OdometryCounters {
  std::uint64_t odometry_seen = 0;
  std::uint64_t odometry_used = 0;
  std::uint64_t odometry_dropped = 0;
  std::uint64_t odometry_gaps = 0;
  std::uint64_t time_jumps = 0;  ///< scans included
  std::uint64_t gyro_seen = 0;
  std::uint64_t gyro_used = 0;
  std::uint64_t gyro_dropped = 0;
};

struct LocalizerCounters : ScanCounters, OdometryCounters {};

}  // namespace racecar_mcl
