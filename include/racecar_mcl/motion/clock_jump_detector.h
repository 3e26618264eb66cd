// Distinguishes one wrong stamp from a jump of the clock.
#pragma once

#include <optional>

namespace racecar_mcl {

enum class StampCheck {
  kPlausible,
  kOutlier,    ///< far from the stamps before it; the next stamp decides what it was
  kClockJump,  ///< far from the stamps before the last outlier, but follows that outlier
};

/// Checks the stamps of one sensor, in the order of arrival. A stamp far from its predecessors is a
/// wrong stamp until a second one follows it: a clock that was set and a bag that loops go on from
/// the new time, a wrong stamp stays alone.
class ClockJumpDetector {
 public:
  /// A stamp that is `max_back` seconds or more before the newest is far.
  explicit ClockJumpDetector(double max_back) : max_back_(max_back) {}

  /// A stamp after `max_stamp` is far. Without `may_jump`, a second far stamp is an outlier as
  /// well.
  StampCheck check(double stamp, double max_stamp, bool may_jump = true);

  double maxBack() const { return max_back_; }  ///< s

  /// The newest stamp that was no outlier.
  std::optional<double> newest() const { return newest_; }

  /// The longest of the recent intervals between plausible stamps, s; 0 before the second stamp.
  double period() const { return period_; }

  /// Accepts any next stamp.
  void reset() { *this = ClockJumpDetector(max_back_); }

 private:
  bool followsOutlier(double stamp, double newest) const;

  double max_back_;
  double period_ = 0.0;
  std::optional<double> newest_;
  std::optional<double> outlier_;  ///< the last stamp, if it was far
};

}  // namespace racecar_mcl
