// What is seen of a localizer on one simulated drive.
#pragma once

#include <optional>
#include <vector>

#include "evaluation/simulated_drive.h"

namespace racecar_mcl {

/// How long something held at a stretch, at most.
class LongestSpell {
 public:
  /// Told at rising times (s) whether it holds: if it does, it has since the time before.
  void see(double seconds, bool holds);
  double longest() const { return longest_; }

 private:
  double last_seconds_ = 0.0;
  std::optional<double> since_;
  double longest_ = 0.0;  // s
};

/// Errors of position, m.
class PositionErrors {
 public:
  void add(double error) { errors_.push_back(error); }
  void add(const PositionErrors& others);

  std::size_t count() const { return errors_.size(); }
  /// All 0 where there is none.
  double mean() const;
  double max() const;
  /// The smallest error that `share` of all do not exceed.
  double quantile(double share) const;
  double shareAbove(double bound) const;

 private:
  std::vector<double> errors_;
};

/// Times are in s since the trouble began. A scan is right where the error is at most 0.5 m.
class DriveWatch {
 public:
  void see(double seconds, const Observation& seen);

  std::optional<double> arrived;  ///< the first error below 15 cm that none above 50 cm follows
  std::optional<double> noticed;  ///< when it was first not trusted
  LongestSpell wrongly_trusted;   ///< localized, it said, while wrong
  long scans = 0;
  long right_scans = 0;
  long false_alarms = 0;

  // Of the scans since the trouble began.
  PositionErrors errors;
  PositionErrors errors_where_mapped;  ///< where the map explains 60 % of the beams or more, seen
                                       ///< from where the car is
  LongestSpell lost_while_right;       ///< lost, it said

  static constexpr double kRight = 0.15;  ///< m
  static constexpr double kWrong = 0.5;   ///< m
  static constexpr double kFarOff = 2.0;  ///< m
};

}  // namespace racecar_mcl
