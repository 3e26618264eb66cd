#include "racecar_mcl/localizer/obstacle_observer.h"

namespace racecar_mcl {
namespace {

constexpr int kMaxBeams = 4000;  // the time of clustering grows with the square of their number

bool isUsable(const LocalizationStatus& status) {
  return status.state == LocalizationState::kLocalized ||
         status.state == LocalizationState::kDegraded;
}

}  // namespace

DetectedObstacles ObstacleObserver::detect(const Localizer& localizer, const Scan& scan,
                                           const ScanResult& result) {
  if (!isUsable(result.status)) return {};
  return detector_.detect(localizer.map()->view(), result.update.estimate,
                          localizer.correctedScan(scan, kMaxBeams));
}

std::vector<ObstacleTrack> ObstacleObserver::track(const DetectedObstacles& obstacles,
                                                   const ScanResult& result) {
  if (!isUsable(result.status)) {
    tracker_.clear();
    return {};
  }
  return tracker_.update(obstacles.clusters, result.stamp);
}

}  // namespace racecar_mcl
