#include "racecar_mcl/obstacles/obstacle_detection.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/filter/point_covariance.h"

namespace racecar_mcl {
namespace {

// Maximum distance between neighbouring returns of a cluster: 2.5 beams of a lidar with 1 degree
// between beams at 5 m.
constexpr double kMaxGap = 0.2;  // m
constexpr double kPoseSigmas = 3.0;
// Distance of an obstacle's centre behind its returns: 0.25 m for the rear of a car, 0.15 m for a
// person.
constexpr double kHalfDepth = 0.2;  // m

/// Single linkage: indices of the columns of `points`, cluster by cluster.
std::vector<std::vector<Eigen::Index>> linkPoints(const Eigen::Matrix2Xd& points) {
  std::vector<Eigen::Index> unlinked(static_cast<std::size_t>(points.cols()));
  std::iota(unlinked.begin(), unlinked.end(), 0);
  std::vector<std::vector<Eigen::Index>> clusters;
  while (!unlinked.empty()) {
    std::vector<Eigen::Index> cluster{unlinked.back()};
    unlinked.pop_back();
    for (std::size_t next = 0; next < cluster.size(); ++next) {
      const Eigen::Vector2d from = points.col(cluster[next]);
      const auto linked = std::partition(unlinked.begin(), unlinked.end(), [&](Eigen::Index other) {
        return (points.col(other) - from).squaredNorm() > kMaxGap * kMaxGap;
      });
      cluster.insert(cluster.end(), linked, unlinked.end());
      unlinked.erase(linked, unlinked.end());
    }
    clusters.push_back(std::move(cluster));
  }
  return clusters;
}

double median(Eigen::ArrayXd values) {
  double* const middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

/// The centre of an obstacle with these returns: behind them, in their mean direction from the
/// lidar. The median range changes less than the mean point when another side comes into view.
Eigen::Vector2d centreBehind(const Eigen::Matrix2Xd& points_in_map, const Pose2& lidar_in_map) {
  const Eigen::Vector2d lidar(lidar_in_map.x, lidar_in_map.y);
  const Eigen::Matrix2Xd offsets = points_in_map.colwise() - lidar;
  const double range = median(offsets.colwise().norm().transpose());
  return lidar +
         (range + kHalfDepth) * offsets.colwise().normalized().rowwise().mean().normalized();
}

ObstacleCluster summarize(const Eigen::Matrix2Xd& points_in_map, const PoseEstimate& estimate,
                          const Pose2& lidar_in_map) {
  const Eigen::Vector2d car(estimate.base_in_map.x, estimate.base_in_map.y);
  ObstacleCluster cluster;
  cluster.position_in_map = centreBehind(points_in_map, lidar_in_map);
  cluster.covariance = pointCovariance(estimate.covariance, cluster.position_in_map - car);
  cluster.extent = (points_in_map.rowwise().maxCoeff() - points_in_map.rowwise().minCoeff()).norm();
  cluster.returns = static_cast<int>(points_in_map.cols());
  return cluster;
}

DetectedObstacles clusterReturns(const Eigen::Matrix2Xd& returns_in_map, int min_returns,
                                 const PoseEstimate& estimate, const Pose2& lidar_in_map) {
  DetectedObstacles obstacles;
  obstacles.points_in_map.resize(2, returns_in_map.cols());
  Eigen::Index count = 0;
  for (const std::vector<Eigen::Index>& linked : linkPoints(returns_in_map)) {
    if (static_cast<int>(linked.size()) < min_returns) continue;
    const Eigen::Index first = count;
    for (const Eigen::Index k : linked) {
      obstacles.points_in_map.col(count++) = returns_in_map.col(k);
    }
    obstacles.clusters.push_back(summarize(obstacles.points_in_map.middleCols(first, count - first),
                                           estimate, lidar_in_map));
  }
  obstacles.points_in_map.conservativeResize(2, count);
  return obstacles;
}

}  // namespace

void validate(const ObstacleDetectionParameters& p) {
  requireWithin("obstacle_distance", p.obstacle_distance, 0.0, 5.0, "m");
  requireWithin("obstacle_min_returns", p.obstacle_min_returns, 1, 1000);
}

ObstacleDetector::ObstacleDetector(const ObstacleDetectionParameters& parameters)
    : parameters_((validate(parameters), parameters)) {}

DetectedObstacles ObstacleDetector::detect(const MapView& map, const PoseEstimate& estimate,
                                           const Scan& beams) {
  // Relative to the car's position, in the axes of the map.
  const Eigen::Matrix2Xd ends =
      endPoints(compose({0.0, 0.0, estimate.base_in_map.yaw}, beams.laser_in_base), beams);
  Eigen::ArrayXf distances(beams.size());
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    const double sigma = majorSigma(pointCovariance(estimate.covariance, ends.col(k)));
    distances[k] = static_cast<float>(parameters_.obstacle_distance + kPoseSigmas * sigma);
  }
  const std::vector<BeamMatch>& matches =
      match_evaluator_.classifyBeams(map, estimate.base_in_map, beams, distances);
  const Eigen::ArrayXXf& expected_ranges = match_evaluator_.expectedRanges();
  Eigen::Matrix2Xd returns(2, beams.size());
  Eigen::Index count = 0;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    const bool is_behind_surface = beams.ranges[k] > expected_ranges(k);
    if (matches[static_cast<std::size_t>(k)] != BeamMatch::kShort || is_behind_surface) continue;
    returns.col(count++) =
        ends.col(k) + Eigen::Vector2d(estimate.base_in_map.x, estimate.base_in_map.y);
  }
  return clusterReturns(returns.leftCols(count), parameters_.obstacle_min_returns, estimate,
                        compose(estimate.base_in_map, beams.laser_in_base));
}

}  // namespace racecar_mcl
