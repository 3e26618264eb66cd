// Learns whether a lidar lists the beams of its sweeps in the order in which it took them.
//
// A LaserScan mostly lists its beams counter-clockwise and gives one time between each and the
// next. The beams of a lidar that turns clockwise are then listed against the order in which it
// took them, and its driver rarely says so. Straightened by such times a sweep comes out bent twice
// as much as before. Which of the two orders makes a sweep lie better on the map shows whenever the
// car turns.
#pragma once

#include "racecar_mcl/likelihood_field.h"
#include "racecar_mcl/pose.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

enum class SweepOrderFrom {
  kLearned,   ///< from the map
  kListed,    ///< beams were taken in the order in which they are listed
  kReversed,  ///< the first beam of the list, at the scan's stamp, was taken last
};

/// The scan with its beams taken the other way about, between the same two times.
Scan mirroredInTime(Scan scan);

/// The log-likelihood of the one scan less that of the other, both from the car at this pose.
double logOddsOfScans(const LikelihoodField& field, const Pose2& base_in_map, const Scan& one,
                      const Scan& other);

class SweepOrder {
 public:
  explicit SweepOrder(SweepOrderFrom from = SweepOrderFrom::kLearned)
      : from_(from), reversed_(from == SweepOrderFrom::kReversed) {}

  bool reversed() const { return reversed_; }
  /// For logs and diagnostics.
  const char* word() const { return reversed_ ? "reversed" : "listed"; }

  /// The scan with the times at which its beams were taken. A list in reverse order is one whose
  /// time between beams has the wrong sign: it begins at the stamp and goes back from there.
  Scan inOrderTaken(Scan scan) const;

  /// Whether a sweep during which the car turned so far (rad) is to be compared with its mirror
  /// image: it is bent enough, and the order is not certain yet.
  bool wantsToCompare(double turned) const;

  /// `log_odds`: of a sweep straightened in the order of now against its mirror image; `turned`: by
  /// how much (rad) the car turned meanwhile. Returns true where that changed the order.
  bool learn(double log_odds, double turned);

  /// What is known may be asked again.
  void startAgain() { certainty_ = 0.0; }

 private:
  SweepOrderFrom from_;
  bool reversed_;
  double certainty_ = 0.0;  ///< log odds of the order of now against the other, from few to many
};

}  // namespace racecar_mcl
