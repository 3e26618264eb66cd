// Monitor of the localization: status of the estimate from inliers, conflicts and odometry.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/monitoring/localizability.h"
#include "racecar_mcl/monitoring/protection_level.h"
#include "racecar_mcl/monitoring/scan_match.h"

namespace racecar_mcl {

enum class LocalizationState {
  kInitializing,  ///< after a start, not yet localized
  kLocalized,
  kDegraded,  ///< the pose may be right, but its error is larger or unknown
  kLost,      ///< the pose is most likely wrong
};

/// "initializing", "localized", "degraded" or "lost".
std::string toString(LocalizationState state);

/// Inlier ratio at the right pose on a complete map, where the other beams graze edges; the initial
/// baseline for every map (docs/decisions.md).
constexpr double kTypicalInlierRatio = 0.95;

struct LocalizationMonitorParameters {
  double inlier_averaging_time = 0.25;  ///< s, time constant of the average of the inlier ratio
  double degraded_deviations = 3.0;  ///< mean absolute deviations below the baseline inlier ratio
                                     ///< from which on the state is degraded
  double lost_conflict = 0.2;        ///< conflict with the map above which the state is lost
  double localized_sigma = 0.3;      ///< m, maximum position sigma of a localized estimate
  /// Correction by scans per distance of odometry (m/m) above which the state is degraded.
  double odometry_disagreement = 0.15;
};

/// Throws ParameterError on a value out of range.
void validate(const LocalizationMonitorParameters& parameters);

struct LocalizationStatus {
  LocalizationState state = LocalizationState::kInitializing;
  std::string reason = "no scan yet";  ///< one line without commas
  double inlier_ratio = 0.0;           ///< averaged
  double baseline_inlier_ratio = 0.0;  ///< expected at the right pose on this map
  double conflict = 0.0;               ///< averaged ScanMatch::conflict() above its baseline
  double carried = 0.0;  ///< m driven by odometry while the map was not informative; decays within
                         ///< metres once it is again
  double disagreement = 0.0;  ///< m corrected by scans per m of odometry, over the last seconds
  /// How well the newest scan alone determines the pose.
  Localizability localizability;
  /// Protection level of the estimate; unbounded while initializing or lost.
  ProtectionLevel level = unboundedLevel();
};

/// Evidence about an estimate after a scan.
struct MonitorInput {
  double stamp = 0.0;        ///< s
  ScanMatch match;           ///< of the scan at the estimate
  bool converged = true;     ///< the particles form a single cluster
  bool unconfirmed = false;  ///< converged, but not confirmed by a second search yet
  bool jumped = false;       ///< the particles were replaced: the correction is no odometry error
  PoseEstimate estimate;
  Localizability localizability = {};
  double travelled = 0.0;  ///< m since the last scan, by odometry
  /// From the position predicted by odometry to the estimate, m, in the car's frame.
  Eigen::Vector2d correction = Eigen::Vector2d::Zero();
};

/// Compares the averaged inlier ratio and conflict of the scans with baselines, which are estimated
/// online for the map and the lidar, since no map is complete.
class LocalizationMonitor {
 public:
  /// Throws as `validate` does.
  explicit LocalizationMonitor(const LocalizationMonitorParameters& parameters,
                               const ProtectionLevelParameters& protection = {});

  /// Status and baselines are kept. Throws as the constructor, and then changes nothing.
  void setParameters(const LocalizationMonitorParameters& parameters,
                     const ProtectionLevelParameters& protection);

  /// A new start: discards the evidence about the last pose, but keeps the baselines.
  void reset();

  const LocalizationStatus& update(const MonitorInput& input);
  /// A scan was received but could not be used.
  const LocalizationStatus& recordUnusableScan(double stamp);

  const LocalizationStatus& status() const { return status_; }
  /// The baseline inlier ratio; kept across starts.
  double baseline() const { return baseline_; }
  bool wasLocalized() const { return was_localized_; }  ///< since the start
  /// False if the inlier ratio is too low for scans alone to determine the pose.
  bool mapIsInformative() const;

 private:
  void average(const MonitorInput& input);
  void updateBaseline(double travelled);
  double minInlierRatio() const;
  double excessConflict() const { return std::max(0.0, conflict_ - baseline_conflict_); }
  LocalizationStatus conclude(const MonitorInput& input) const;

  LocalizationMonitorParameters parameters_;
  ProtectionLevelParameters protection_;
  LocalizationStatus status_;
  double baseline_;
  double baseline_conflict_;
  double deviation_;  ///< mean absolute deviation of the inlier ratio from its baseline
  double inlier_ratio_ = 0.0;
  double conflict_ = 0.0;
  double carried_ = 0.0;                                  ///< m
  double last_stamp_ = 0.0;                               ///< s
  bool has_scan_ = false;                                 ///< a scan since the start
  bool was_localized_ = false;                            ///< since the start
  std::optional<double> unusable_since_;                  ///< s
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();  ///< m, fading sum
  double travelled_ = 0.0;                                ///< m, fading sum
  double since_start_ = 0.0;                              ///< m driven since a start or jump
};

}  // namespace racecar_mcl
