// Estimation of the acquisition order of a lidar's beams.
//
// A LaserScan lists its beams counter-clockwise with a constant time between them. For a lidar that
// rotates clockwise, beams are listed in reverse acquisition order, and few drivers correct the
// times. Deskewing with such times doubles the distortion. While the car turns, the order with
// which the deskewed sweep matches the map better is the right one.
#pragma once

#include "racecar_mcl/geometry/pose2.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

enum class ScanDirectionFrom {
  kAuto,      ///< estimated from scans and map
  kListed,    ///< beams are listed in acquisition order
  kReversed,  ///< beams are listed in reverse acquisition order: the first one, at the stamp, is
              ///< the last
};

/// "listed" or "reversed", for reports and diagnostics.
inline const char* scanDirectionName(bool reversed) { return reversed ? "reversed" : "listed"; }

/// The scan with reversed acquisition order within the same interval of time.
Scan mirroredInTime(Scan scan);

/// The log-likelihood of `one` minus that of `other`, both with the car at this pose.
double scanLogOdds(const LikelihoodField& field, const Pose2& base_in_map, const Scan& one,
                   const Scan& other);

/// Accumulates the log odds of the two orders.
class ScanDirection {
 public:
  explicit ScanDirection(ScanDirectionFrom from = ScanDirectionFrom::kAuto)
      : from_(from), reversed_(from == ScanDirectionFrom::kReversed) {}

  /// Restarts the estimation if the source of the order changes.
  void setSource(ScanDirectionFrom from) {
    if (from != from_) *this = ScanDirection(from);
  }

  /// Whether beams are listed in reverse acquisition order: the times after the stamp are negative.
  bool isReversed() const { return reversed_; }

  /// Continues with the order of an earlier run, unless the order is given.
  void resume(bool reversed) {
    if (from_ == ScanDirectionFrom::kAuto) reversed_ = reversed;
  }

  /// Whether a sweep should be evaluated in both orders: the car `turned` (rad) enough during it,
  /// and the order is not certain yet.
  bool needsComparison(double turned) const;

  /// Adds the evidence of one sweep. `log_odds`: of the sweep deskewed in the current order against
  /// the opposite one; `turned`: turn of the car during the sweep, rad. Returns true if the order
  /// changed.
  bool learn(double log_odds, double turned);

  /// Keeps the order, but discards its certainty.
  void reset() { certainty_ = 0.0; }

 private:
  ScanDirectionFrom from_;
  bool reversed_;
  double certainty_ = 0.0;  ///< accumulated log odds of the current order
};

}  // namespace racecar_mcl
