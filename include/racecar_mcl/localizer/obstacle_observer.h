// Obstacles in the scans of a localizer: detection at the estimated pose, and tracking.
#pragma once

#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/obstacles/obstacle_detection.h"
#include "racecar_mcl/obstacles/obstacle_tracker.h"

namespace racecar_mcl {

class ObstacleObserver {
 public:
  /// Throws as `validate` does.
  explicit ObstacleObserver(const ObstacleDetectionParameters& parameters)
      : detector_(parameters) {}

  /// The tracks are kept. Throws as `validate` does.
  void setParameters(const ObstacleDetectionParameters& parameters) {
    detector_ = ObstacleDetector(parameters);
  }

  /// The obstacles in the newest scan of the localizer, whose update had this result. Precondition:
  /// its outcome has an estimate. None unless the status is `localized` or `degraded`.
  DetectedObstacles detect(const Localizer& localizer, const Scan& scan, const ScanResult& result);
  /// The tracks after a scan with this result, in which these obstacles were detected. None unless
  /// the status is `localized` or `degraded`.
  std::vector<ObstacleTrack> track(const DetectedObstacles& obstacles, const ScanResult& result);

 private:
  ObstacleDetector detector_;
  ObstacleTracker tracker_;
};

}  // namespace racecar_mcl
