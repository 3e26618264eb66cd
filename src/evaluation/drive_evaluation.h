// Accuracy and self-diagnosis of a localizer on one simulated drive.
#pragma once

#include <optional>
#include <vector>

#include "offline/simulated_drive.h"

namespace racecar_mcl {

/// The longest interval during which a condition held.
class LongestInterval {
 public:
  /// At increasing times (s). A condition that holds has held since the previous update.
  void update(double seconds, bool active);
  double longest() const { return longest_; }

 private:
  double last_seconds_ = 0.0;
  std::optional<double> since_;
  double longest_ = 0.0;  // s
};

/// Position errors, m.
class PositionErrors {
 public:
  void add(double error) { errors_.push_back(error); }
  void add(const PositionErrors& others);

  std::size_t count() const { return errors_.size(); }
  /// All statistics are 0 without errors.
  double mean() const;
  double max() const;
  /// The smallest error that is not exceeded by `fraction` of all errors.
  double quantile(double fraction) const;
  double fractionAbove(double bound) const;

 private:
  std::vector<double> errors_;
};

/// Times are in s since the fault was injected. An estimate is correct if its error is at most 0.5
/// m.
class DriveEvaluation {
 public:
  void update(double seconds, const Observation& observation);

  std::optional<double> arrived;   ///< first error below 15 cm after the last above 50 cm
  std::optional<double> detected;  ///< first status other than `localized`
  LongestInterval misleading;      ///< status `localized` while incorrect
  long scans = 0;
  long correct_scans = 0;
  long false_alarms = 0;

  // Since the fault was injected.
  PositionErrors errors;
  PositionErrors errors_where_mapped;  ///< at an inlier ratio of at least 60 % from the true
                                       ///< pose
  LongestInterval lost_while_correct;  ///< status `lost` while correct

  static constexpr double kArrivalError = 0.15;    ///< m
  static constexpr double kMaxCorrectError = 0.5;  ///< m
  static constexpr double kGrossError = 2.0;       ///< m
};

}  // namespace racecar_mcl
