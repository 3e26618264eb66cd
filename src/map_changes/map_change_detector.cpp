#include "map_changes/map_change_detector.h"

#include <cmath>

#include "racecar_mcl/filter/point_covariance.h"

namespace racecar_mcl {
namespace {

constexpr int kMaxBeams = 4000;
constexpr double kViewDistance = 0.1;  // m between views, so that a slow car does not dominate
constexpr double kMinRange = 0.3;      // m; shorter ranges are returns of a covered lidar
constexpr double kPoseSigmas = 2.5;
constexpr double kMaxTolerance = 0.15;  // m; beams with less accurate ends are not used
// After a kidnapping the status remains `localized` for less than that.
constexpr double kConfirmationTime = 2.0;  // s

}  // namespace

View viewOf(const PoseEstimate& estimate, const Scan& beams) {
  const Pose2 lidar = compose(estimate.base_in_map, beams.laser_in_base);
  const Eigen::Vector2d base(estimate.base_in_map.x, estimate.base_in_map.y);
  View view;
  view.stamp = beams.stamp;
  view.lidar_in_map = {lidar.x, lidar.y};
  const Eigen::Matrix2Xd ends = endPoints(lidar, beams);
  view.ends_in_map.resize(2, beams.size());
  view.tolerances.resize(beams.size());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    const auto range = static_cast<double>(beams.ranges[k]);
    if (!std::isfinite(range) || range < kMinRange) continue;
    const Eigen::Vector2d end = ends.col(k);
    const double tolerance =
        kPoseSigmas * majorSigma(pointCovariance(estimate.covariance, end - base));
    if (tolerance > kMaxTolerance) continue;
    view.ends_in_map.col(count) = end;
    view.tolerances[count++] = tolerance;
  }
  view.ends_in_map.conservativeResize(2, count);
  view.tolerances.conservativeResize(count);
  return view;
}

void MapChangeDetector::add(const Localizer& localizer, const Scan& scan,
                            const ScanResult& result) {
  const LocalizationState state = result.status.state;
  if (state == LocalizationState::kLocalized) {
    localized_until_ = result.stamp;
    addWaiting(result.stamp - kConfirmationTime);
  } else if (state != LocalizationState::kDegraded) {
    waiting_.clear();
    return;
  }
  const PoseEstimate& estimate = result.update.estimate;
  if (result.outcome != ScanOutcome::kUsed ||
      (last_view_ && distance(*last_view_, estimate.base_in_map) < kViewDistance)) {
    return;
  }
  last_view_ = estimate.base_in_map;
  waiting_.push_back(viewOf(estimate, localizer.correctedScan(scan, kMaxBeams)));
}

void MapChangeDetector::addWaiting(double until) {
  for (; !waiting_.empty() && waiting_.front().stamp <= until; waiting_.pop_front()) {
    evidence_.add(waiting_.front());
  }
}

MapChanges MapChangeDetector::finish() {
  addWaiting(localized_until_);
  return findChanges(grid_, evidence_);
}

}  // namespace racecar_mcl
