// When the map is searched for another place than the one where the car is taken to be.
#pragma once

#include <optional>

namespace racecar_mcl {

/// A state machine without a map: evidence in, action out.
///
///     content --(conflict for 0.2 s and 6 scans)--> search --(proven)--> adopt
///        ^                                            |
///        +----(rejected or confirmed: wait, each time twice as long)----+
///
/// Conflict is what the map shows to be wrong. Beams that end where the map is unknown are none:
/// while the map is silent the carried pose is kept, however little of the scans it explains.
class RecoveryPolicy {
 public:
  /// What a scan showed.
  struct Evidence {
    double stamp = 0.0;     ///< s
    bool settled = false;   ///< the particles are in one place
    double conflict = 0.0;  ///< of the scans of late, as LocalizationStatus has it
  };

  /// Takes in one scan. True where a search is to begin with the next one.
  bool update(const Evidence& evidence);

  /// A search that was begun has come to nothing.
  void onRejected(double stamp);
  /// A search has given another place, or the car was started anew.
  void reset();

  /// Whether scans contradict the carried pose at the moment.
  bool inConflict() const { return conflict_since_.has_value(); }

 private:
  std::optional<double> conflict_since_;  ///< s
  int scans_in_conflict_ = 0;             ///< one after the other
  double last_rejected_ = -1e18;          ///< s
  double pause_ = 0.0;                    ///< s, from then on
};

}  // namespace racecar_mcl
