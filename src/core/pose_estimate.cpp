#include "racecar_mcl/pose_estimate.h"

#include <algorithm>
#include <numeric>

#include "pose_bins.h"

namespace racecar_mcl {
namespace {

using Indices = std::vector<Eigen::Index>;

Indices allOf(const ParticleSet& particles) {
  Indices indices(static_cast<std::size_t>(particles.size()));
  std::iota(indices.begin(), indices.end(), Eigen::Index{0});
  return indices;
}

double totalWeight(const ParticleSet& particles, const Indices& indices) {
  double sum = 0.0;
  for (const Eigen::Index i : indices) sum += std::exp(particles.log_weight[i]);
  return sum;
}

Pose2 meanPose(const ParticleSet& particles, const Indices& indices, double total) {
  // Sums about the first particle keep their digits far from the map's origin.
  const Pose2 first = particles.pose(indices.front());
  double x = 0.0, y = 0.0, sine = 0.0, cosine = 0.0;
  for (const Eigen::Index i : indices) {
    const double weight = std::exp(particles.log_weight[i]) / total;
    x += weight * (particles.x[i] - first.x);
    y += weight * (particles.y[i] - first.y);
    cosine += weight * std::cos(particles.yaw[i] - first.yaw);
    sine += weight * std::sin(particles.yaw[i] - first.yaw);
  }
  const bool cancels = std::hypot(sine, cosine) < 1e-9;
  return {first.x + x, first.y + y,
          wrapAngle(first.yaw + (cancels ? 0.0 : std::atan2(sine, cosine)))};
}

Eigen::Matrix3d covarianceAbout(const Pose2& centre, const ParticleSet& particles,
                                const Indices& indices, double total) {
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Index i : indices) {
    const Eigen::Vector3d offset(particles.x[i] - centre.x, particles.y[i] - centre.y,
                                 wrapAngle(particles.yaw[i] - centre.yaw));
    covariance += std::exp(particles.log_weight[i]) / total * offset * offset.transpose();
  }
  return covariance;
}

PoseEstimate meanOf(const ParticleSet& particles, const Indices& indices, double total) {
  const Pose2 mean = meanPose(particles, indices, total);
  return {mean, covarianceAbout(mean, particles, indices, total)};
}

/// The bins within one step in x, y and yaw, itself included.
template <typename Visit>
void forEachNeighbour(const PoseBin& bin, std::int32_t yaw_bins, Visit&& visit) {
  for (std::int32_t dx = -1; dx <= 1; ++dx) {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dyaw = -1; dyaw <= 1; ++dyaw) {
        visit(PoseBin{bin.x + dx, bin.y + dy, (bin.yaw + dyaw + yaw_bins) % yaw_bins});
      }
    }
  }
}

}  // namespace

double positionSigma(const PoseEstimate& estimate) {
  const Eigen::Matrix3d& c = estimate.covariance;
  const double middle = 0.5 * (c(0, 0) + c(1, 1));
  return std::sqrt(std::max(0.0, middle + std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1))));
}

PoseEstimate weightedMean(const ParticleSet& particles) {
  const Indices all = allOf(particles);
  return meanOf(particles, all, totalWeight(particles, all));
}

PoseEstimate bestParticle(const ParticleSet& particles) {
  Eigen::Index best = 0;
  particles.log_weight.maxCoeff(&best);
  const Indices all = allOf(particles);
  const Pose2 pose = particles.pose(best);
  return {pose, covarianceAbout(pose, particles, all, totalWeight(particles, all))};
}

std::vector<Cluster> findClusters(const ParticleSet& particles, const PoseBins& bins) {
  BinnedParticles unvisited = groupByBin(particles, bins);
  const std::int32_t yaw_bins = yawBinCount(bins);
  const double total = totalWeight(particles, allOf(particles));

  std::vector<Cluster> clusters;
  // Seeds are taken in the order of the particles, so that the result does not depend on the hash.
  for (Eigen::Index seed = 0; seed < particles.size(); ++seed) {
    std::vector<PoseBin> frontier{binOf(particles.pose(seed), bins)};
    Indices members;
    while (!frontier.empty()) {
      const PoseBin bin = frontier.back();
      frontier.pop_back();
      const auto found = unvisited.find(bin);
      if (found == unvisited.end()) continue;
      members.insert(members.end(), found->second.begin(), found->second.end());
      unvisited.erase(found);
      forEachNeighbour(bin, yaw_bins, [&](const PoseBin& next) { frontier.push_back(next); });
    }
    if (members.empty()) continue;
    std::sort(members.begin(), members.end());
    const double weight = totalWeight(particles, members);
    if (weight <= 0.0) continue;
    clusters.push_back({meanOf(particles, members, weight), weight / total,
                        static_cast<Eigen::Index>(members.size())});
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.weight > b.weight; });
  return clusters;
}

PoseEstimate estimatePose(const ParticleSet& particles, EstimateFrom from) {
  switch (from) {
    case EstimateFrom::kMean:
      return weightedMean(particles);
    case EstimateFrom::kBest:
      return bestParticle(particles);
    case EstimateFrom::kCluster:
      return findClusters(particles).front().estimate;
  }
  return weightedMean(particles);
}

PoseEstimate carryForward(const PoseEstimate& estimate, const Pose2& delta,
                          const Eigen::Matrix3d& noise) {
  const double c = std::cos(estimate.base_in_map.yaw);
  const double s = std::sin(estimate.base_in_map.yaw);
  Eigen::Matrix3d by_pose = Eigen::Matrix3d::Identity();
  by_pose(0, 2) = -s * delta.x - c * delta.y;
  by_pose(1, 2) = c * delta.x - s * delta.y;
  Eigen::Matrix3d by_noise = Eigen::Matrix3d::Identity();
  by_noise.topLeftCorner<2, 2>() << c, -s, s, c;
  return {compose(estimate.base_in_map, delta),
          by_pose * estimate.covariance * by_pose.transpose() +
              by_noise * noise * by_noise.transpose()};
}

}  // namespace racecar_mcl
