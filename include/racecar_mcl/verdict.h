// Whether the estimate can be believed, said without knowing the truth.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "racecar_mcl/scan_fit.h"

namespace racecar_mcl {

enum class VerdictState {
  kConverging,  ///< since a start: not yet sure
  kLocalized,
  kDegraded,  ///< the pose may be right, but something speaks against it
  kLost,      ///< the pose is most likely wrong
};

/// "converging", "localized", "degraded" or "lost".
std::string describe(VerdictState state);

/// The share of the beams that a good map explains, the rest grazing edges: believed of every map
/// until it was seen.
constexpr double kUsualOfGoodMaps = 0.95;

struct VerdictParameters {
  double verdict_time = 0.25;           ///< s, over which the share of explained beams is averaged
  double degraded_deviations = 3.0;     ///< so many deviations below the usual share is degraded
  double lost_below = 0.6;              ///< less than this of the usual share is lost
  double localized_sigma = 0.3;         ///< m, a wider estimate is not localized
  double odometry_disagreement = 0.15;  ///< m that scans correct per m that odometry tells of
};

/// Throws ParameterError on a value out of range.
void validate(const VerdictParameters& parameters);

struct Verdict {
  VerdictState state = VerdictState::kConverging;
  std::string reason = "no scan yet";  ///< one line without commas
  double explained = 0.0;              ///< share of explained beams, averaged
  double usually = 0.0;                ///< what that is while all is well
  double disagreement = 0.0;  ///< m that scans corrected per m that odometry told of, of late
};

/// What is known of an estimate after a scan.
struct Evidence {
  double stamp = 0.0;           ///< s
  ScanFit fit;                  ///< of the scan, from the estimate
  bool converging = false;      ///< the particles have not settled on one place
  bool unconfirmed = false;     ///< on this one they have, but a second search has not agreed yet
  bool moved = false;           ///< to another place: what scans corrected says nothing of this one
  double position_sigma = 0.0;  ///< m, the larger axis of the estimate
  double travelled = 0.0;       ///< m, since the last scan, says odometry
  Eigen::Vector2d correction = Eigen::Vector2d::Zero();  ///< m, from where odometry put the car to
                                                         ///< where the scan did, in the car's frame
};

/// Gathers evidence from scan to scan. The share of explained beams is held against what is usual
/// with this map and this lidar, which is learnt while localized: no map shows everything.
class Judge {
 public:
  /// Throws as `validate` does.
  explicit Judge(const VerdictParameters& parameters);

  /// A new start: what was known of the last pose says nothing any more.
  void startAgain();

  const Verdict& judge(const Evidence& evidence);
  /// A scan that came but could not be used.
  const Verdict& judgeUnusable(double stamp);

  /// The whole map was searched for a place that explains the last scan better, in vain: then this
  /// much is usual.
  void acceptAsUsual();

  const Verdict& verdict() const { return verdict_; }
  /// The share of explained beams that is usual, also across starts.
  double usual() const { return usual_; }
  /// For how long, s, scans were explained worse than usual by an estimate that had settled.
  double doubtfulFor() const { return doubtful_since_ ? last_stamp_ - *doubtful_since_ : 0.0; }
  /// And how many scans that were.
  int doubtfulScans() const { return doubtful_scans_; }

 private:
  void followClock(double stamp);
  void average(const Evidence& evidence);
  void learnUsual(double travelled);
  double leastUsual() const;
  Verdict conclude(const Evidence& evidence) const;

  VerdictParameters parameters_;
  Verdict verdict_;
  double usual_;
  double deviation_;  ///< mean absolute, from the usual share
  double explained_ = 0.0;
  double last_stamp_ = 0.0;                               ///< s
  bool heard_ = false;                                    ///< a scan since the start
  bool was_localized_ = false;                            ///< since the start
  std::optional<double> doubtful_since_;                  ///< s
  int doubtful_scans_ = 0;                                ///< one after the other
  std::optional<double> unusable_since_;                  ///< s
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();  ///< m, in the last seconds
  double travelled_ = 0.0;                                ///< m, in the last seconds
};

}  // namespace racecar_mcl
