#include "racecar_mcl/filter/convergence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/filter/resampling.h"

namespace racecar_mcl {
namespace {

// Exponent of consecutive scans: driving distance equivalent to a turn, and minimum
// (docs/maths.md).
constexpr double kMetresPerRadian = 0.5;  // m/rad
constexpr double kStationaryDecorrelation = 0.02;
// A set has converged if one cluster has this weight and at most this spread (docs/decisions.md).
constexpr double kSingleClusterWeight = 0.9999;
constexpr double kSingleClusterSigma = 0.3;  // m
// Poses within these limits count as the same place (docs/maths.md).
constexpr double kSamePlaceDistance = 1.0;  // m
constexpr double kSamePlaceYaw = 0.5;       // rad

}  // namespace

double decorrelationAfter(const Motion& motion, double scan_decorrelation_distance) {
  if (scan_decorrelation_distance <= 0.0) return 1.0;
  const double travelled = motion.distance + kMetresPerRadian * motion.rotation;
  return std::min(1.0, std::max(kStationaryDecorrelation, travelled / scan_decorrelation_distance));
}

std::optional<Pose2> singleCluster(const std::vector<Cluster>& clusters) {
  if (clusters.empty() || clusters.front().weight < kSingleClusterWeight) return std::nullopt;
  const PoseEstimate& estimate = clusters.front().estimate;
  const double variance = estimate.covariance.topLeftCorner<2, 2>().trace();
  if (variance > kSingleClusterSigma * kSingleClusterSigma) return std::nullopt;
  return estimate.base_in_map;
}

bool isSamePlace(const Pose2& a, const Pose2& b) {
  return distance(a, b) <= kSamePlaceDistance &&
         std::abs(wrapAngle(a.yaw - b.yaw)) <= kSamePlaceYaw;
}

void keepNear(const Pose2& place, ParticleSet* particles) {
  for (Eigen::Index i = 0; i < particles->size(); ++i) {
    if (!isSamePlace(particles->pose(i), place)) {
      particles->log_weight[i] = -std::numeric_limits<double>::infinity();
    }
  }
  normalizeLogWeights(&particles->log_weight);
}

}  // namespace racecar_mcl
