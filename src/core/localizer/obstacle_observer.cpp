#include "racecar_mcl/localizer/obstacle_observer.h"

#include "racecar_mcl/scan/beam_selection.h"

namespace racecar_mcl {
namespace {

constexpr int kMaxBeams =
    4000;  // more are thinned out: clustering takes the square of their number

bool isUsable(const LocalizationStatus& status) {
  return status.state == LocalizationState::kLocalized ||
         status.state == LocalizationState::kDegraded;
}

}  // namespace

Scan correctedScan(const Localizer& localizer, const Scan& scan) {
  const ScanParameters& parameters = localizer.parameters().scan;
  const auto poseAfter = [&](double seconds) {
    return localizer.estimateAt(scan.stamp + seconds).value().base_in_map;
  };
  const Pose2 base_in_map = poseAfter(0.0);
  return ScanPreprocessor(parameters)
      .correct(selectBeams(scan, kMaxBeams, parameters.scan_field_of_view),
               {localizer.sensorCalibration().range_bias, localizer.scanDirection().isReversed()},
               [&](double seconds) { return between(base_in_map, poseAfter(seconds)); })
      .beams;
}

DetectedObstacles ObstacleObserver::detect(const Localizer& localizer, const Scan& scan,
                                           const ScanResult& result) {
  if (!isUsable(result.status)) return {};
  return detector_.detect(localizer.map()->view(), result.update.estimate,
                          correctedScan(localizer, scan));
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
