#include "racecar_mcl/convergence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/resampling.h"

namespace racecar_mcl {
namespace {

constexpr double kMetresPerRadian = 0.5;
constexpr double kNewsOfStanding = 0.02;
constexpr double kAlmostAll = 0.9999;
constexpr double kOnePlaceSigma = 0.3;  // m
constexpr double kNear = 1.0;           // m
constexpr double kNearYaw = 0.5;        // rad

}  // namespace

double newsAfter(const Motion& motion, double news_distance) {
  if (news_distance <= 0.0) return 1.0;
  const double travelled = motion.distance + kMetresPerRadian * motion.rotation;
  return std::min(1.0, std::max(kNewsOfStanding, travelled / news_distance));
}

std::optional<Pose2> onlyPlace(const std::vector<Cluster>& clusters) {
  if (clusters.empty() || clusters.front().weight < kAlmostAll) return std::nullopt;
  const PoseEstimate& estimate = clusters.front().estimate;
  const double variance = estimate.covariance.topLeftCorner<2, 2>().trace();
  if (variance > kOnePlaceSigma * kOnePlaceSigma) return std::nullopt;
  return estimate.base_in_map;
}

bool isSamePlace(const Pose2& a, const Pose2& b) {
  return distance(a, b) <= kNear && std::abs(wrapAngle(a.yaw - b.yaw)) <= kNearYaw;
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
