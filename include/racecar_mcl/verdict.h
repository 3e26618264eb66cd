// Whether the estimate can be believed, said without knowing the truth.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>

#include "racecar_mcl/pose_estimate.h"
#include "racecar_mcl/protection_level.h"
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

/// The share of the beams that a good map explains, the rest grazing edges: assumed of every map
/// until it was seen.
constexpr double kUsualOfGoodMaps = 0.95;

struct VerdictParameters {
  double verdict_time = 0.25;           ///< s, over which the share of explained beams is averaged
  double degraded_deviations = 3.0;     ///< so many deviations below the usual share is degraded
  double lost_conflict = 0.2;           ///< a larger conflict with the map is lost
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
  double conflict = 0.0;  ///< share of beams that pass through mapped surfaces, and half the share
                          ///< of those that end before them, averaged, beyond what is usual
  double carried = 0.0;   ///< m driven while the map was silent; fades within metres once it
                          ///< explains the scans again
  double disagreement = 0.0;  ///< m that scans corrected per m that odometry told of, of late
  ProtectionLevel level =
      unboundedLevel();  ///< of the estimate; unbounded while converging or lost
};

/// What is known of an estimate after a scan.
struct Evidence {
  double stamp = 0.0;           ///< s
  ScanFit fit;                  ///< of the scan, from the estimate
  bool converging = false;      ///< the particles have not settled on one place
  bool unconfirmed = false;     ///< on this one they have, but a second search has not agreed yet
  bool moved = false;           ///< to another place: what scans corrected says nothing of this one
  double position_sigma = 0.0;  ///< m, the larger axis of the estimate
  PoseEstimate estimate;
  double travelled = 0.0;                                ///< m, since the last scan, says odometry
  Eigen::Vector2d correction = Eigen::Vector2d::Zero();  ///< m, from where odometry put the car to
                                                         ///< where the scan did, in the car's frame
};

/// Gathers evidence from scan to scan. The share of explained beams is held against what is usual
/// with this map and this lidar, which is learnt while localized: no map shows everything.
class Judge {
 public:
  /// Throws as `validate` does.
  explicit Judge(const VerdictParameters& parameters,
                 const ProtectionLevelParameters& protection = {});

  /// A new start: what was known of the last pose says nothing any more.
  void startAgain();

  const Verdict& judge(const Evidence& evidence);
  /// A scan that came but could not be used.
  const Verdict& judgeUnusable(double stamp);

  const Verdict& verdict() const { return verdict_; }
  /// The share of explained beams that is usual, also across starts.
  double usual() const { return usual_; }
  bool wasLocalized() const { return was_localized_; }  ///< since the start
  /// The map does not show enough of what the lidar sees: scans alone cannot hold the pose.
  bool mapIsSilent() const;

 private:
  void average(const Evidence& evidence);
  void learnUsual(double travelled);
  double leastUsual() const;
  double excessConflict() const { return std::max(0.0, conflict_ - usual_conflict_); }
  Verdict conclude(const Evidence& evidence) const;

  VerdictParameters parameters_;
  ProtectionLevelParameters protection_;
  Verdict verdict_;
  double usual_;
  double usual_conflict_;
  double deviation_;  ///< mean absolute, from the usual share
  double explained_ = 0.0;
  double conflict_ = 0.0;
  double carried_ = 0.0;                                  ///< m
  double last_stamp_ = 0.0;                               ///< s
  bool heard_ = false;                                    ///< a scan since the start
  bool was_localized_ = false;                            ///< since the start
  std::optional<double> unusable_since_;                  ///< s
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();  ///< m, in the last seconds
  double travelled_ = 0.0;                                ///< m, in the last seconds
};

}  // namespace racecar_mcl
