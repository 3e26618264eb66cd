// Recovery policy: decides when to search the map for another pose. Pure state machine.
#pragma once

#include <optional>

namespace racecar_mcl {

///     idle --(conflict for 0.2 s and 6 scans)--> search --(proven)--> adopt
///      ^                                            |
///      +---(rejected or confirmed: pause, doubled each time, 0.5 to 16 s)
///
/// Only beams that contradict the map are a conflict. Beams that end in unknown cells are not: in
/// unmapped areas the current pose is kept, even with a low inlier ratio.
class RecoveryPolicy {
 public:
  /// Evidence of one scan.
  struct Evidence {
    double stamp = 0.0;      ///< s
    bool converged = false;  ///< the particle filter has converged
    double conflict = 0.0;   ///< LocalizationStatus::conflict
  };

  /// Processes the evidence of one scan.
  void update(const Evidence& evidence);
  /// Whether a search should start with the next scan.
  bool searchIsDue() const { return search_is_due_; }

  /// A search has ended without a new pose.
  void onRejected(double stamp);
  /// A search has given a new pose, or the localizer was restarted.
  void reset();

  /// Whether the last scans contradict the current pose.
  bool inConflict() const { return conflict_since_.has_value(); }

 private:
  std::optional<double> conflict_since_;  ///< s
  int scans_in_conflict_ = 0;             ///< consecutive
  double last_rejected_ = -1e18;          ///< s
  double pause_ = 0.0;                    ///< s, from then on
  bool search_is_due_ = false;
};

}  // namespace racecar_mcl
