// Detection of unmapped obstacles: returns in front of the map's surfaces, and their clusters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/monitoring/scan_match.h"
#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"

namespace racecar_mcl {

struct ObstacleDetectionParameters {
  double obstacle_distance = 0.06;  ///< m, minimum distance of returns from mapped surfaces,
                                    ///< besides three standard deviations due to the pose
  int obstacle_min_returns = 3;     ///< of a cluster; smaller ones are dropped
};

/// Throws ParameterError on a value out of range.
void validate(const ObstacleDetectionParameters& parameters);

/// Neighbouring returns that the map does not explain.
struct ObstacleCluster {
  Eigen::Vector2d position_in_map;  ///< m, of the centre, assumed 0.2 m behind the returns
  Eigen::Matrix2d covariance;       ///< m^2, of the position, due to the pose
  double extent = 0.0;              ///< m, diagonal of the returns' bounding box
  int returns = 0;
};

struct DetectedObstacles {
  Eigen::Matrix2Xd points_in_map;  ///< m, 2 x N: the returns of all clusters, cluster by cluster
  std::vector<ObstacleCluster> clusters;
};

/// A return belongs to an obstacle if ScanMatchEvaluator classifies it as BeamMatch::kShort, with
/// an inlier distance for the noise and the uncertainty of the pose, and if it is not behind the
/// first surface on its ray: it ends in known free space in front of the mapped surfaces. Clusters
/// are formed by single linkage of returns within 0.2 m.
class ObstacleDetector {
 public:
  /// Throws as `validate` does.
  explicit ObstacleDetector(const ObstacleDetectionParameters& parameters);

  /// `beams`: deskewed, as seen from the estimated pose.
  DetectedObstacles detect(const MapView& map, const PoseEstimate& estimate, const Scan& beams);

 private:
  ObstacleDetectionParameters parameters_;
  ScanMatchEvaluator match_evaluator_;
};

}  // namespace racecar_mcl
