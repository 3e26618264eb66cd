// Finds the changes of a map from the scans of a localizer.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "map_changes/map_changes.h"
#include "racecar_mcl/localizer/localizer.h"

namespace racecar_mcl {

/// `beams`: corrected and deskewed, seen from the pose. Beams without a return are no evidence, nor
/// those whose end is uncertain by the pose.
View viewOf(const PoseEstimate& estimate, const Scan& beams);

/// Selects the scans that are views: the pose is accurate, and the car has moved since the last
/// view. The status is `localized`, or `degraded` between two times at which it is `localized`: it
/// is degraded where much has changed.
class MapChangeDetector {
 public:
  /// `grid`: the map of the localizer.
  explicit MapChangeDetector(OccupancyGrid grid) : grid_(std::move(grid)), evidence_(grid_) {}

  /// A scan whose update had this result. Precondition: its outcome has an estimate.
  void add(const Localizer& localizer, const Scan& scan, const ScanResult& result);

  /// Call it after the last scan.
  MapChanges finish();

  /// The number of scans that were used so far.
  std::uint32_t views() const { return evidence_.views(); }

 private:
  void addWaiting(double until);

  OccupancyGrid grid_;
  CellEvidence evidence_;
  std::deque<View> waiting_;        ///< until the status has been confirmed
  double localized_until_ = 0.0;    ///< s, stamp of the newest scan with the status `localized`
  std::optional<Pose2> last_view_;  ///< base_in_map
};

}  // namespace racecar_mcl
