#include "racecar_mcl/pose_estimate.h"

#include <algorithm>
#include <array>

#include "pose_bins.h"
#include "vector_math.h"

namespace racecar_mcl {
namespace {

using Indices = std::vector<Eigen::Index>;

/// Weighted sums over particles, in an order that does not depend on the instruction set.
class WeightedSums {
 public:
  WeightedSums(const ParticleSet& particles, const Eigen::ArrayXd& weights)
      : x_(particles.x.data()),
        y_(particles.y.data()),
        yaw_(particles.yaw.data()),
        weights_(weights.data()),
        size_(static_cast<int>(particles.size())) {}

  Pose2 mean() const {
    // Sums about the first particle keep their digits far from the map's origin.
    const Pose2 first{x_[0], y_[0], yaw_[0]};
    std::array<double, 5> sums;
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      sums = sumTerms<5>([&](int i, double weight, double* const* terms, int k)
                             RACECAR_MCL_INLINE_LAMBDA {
                               double sine, cosine;
                               sinCos(yaw_[i] - first.yaw, &sine, &cosine);
                               terms[0][k] = weight;
                               terms[1][k] = weight * (x_[i] - first.x);
                               terms[2][k] = weight * (y_[i] - first.y);
                               terms[3][k] = weight * sine;
                               terms[4][k] = weight * cosine;
                             });
    });
    const double sine = sums[3] / sums[0];
    const double cosine = sums[4] / sums[0];
    const bool cancels = std::hypot(sine, cosine) < 1e-9;
    return {first.x + sums[1] / sums[0], first.y + sums[2] / sums[0],
            wrapAngle(first.yaw + (cancels ? 0.0 : std::atan2(sine, cosine)))};
  }

  Eigen::Matrix3d covarianceAbout(const Pose2& centre) const {
    std::array<double, 7> sums;
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      sums = sumTerms<7>([&](int i, double weight, double* const* terms, int k)
                             RACECAR_MCL_INLINE_LAMBDA {
                               const double dx = x_[i] - centre.x;
                               const double dy = y_[i] - centre.y;
                               const double dyaw = wrapAngleFast(yaw_[i] - centre.yaw);
                               terms[0][k] = weight;
                               terms[1][k] = weight * dx * dx;
                               terms[2][k] = weight * dx * dy;
                               terms[3][k] = weight * dx * dyaw;
                               terms[4][k] = weight * dy * dy;
                               terms[5][k] = weight * dy * dyaw;
                               terms[6][k] = weight * dyaw * dyaw;
                             });
    });
    Eigen::Matrix3d covariance;
    covariance << sums[1], sums[2], sums[3], sums[2], sums[4], sums[5], sums[3], sums[5], sums[6];
    return covariance / sums[0];
  }

 private:
  /// `term(i, weight, terms, k)` writes what particle i adds to each sum to terms[sum][k].
  template <std::size_t kSums, typename Term>
  RACECAR_MCL_INLINE std::array<double, kSums> sumTerms(const Term& term) const {
    constexpr int kBlock = 256;
    alignas(64) double values[kSums][kBlock];
    double* terms[kSums];
    for (std::size_t sum = 0; sum < kSums; ++sum) terms[sum] = values[sum];
    LaneSum sums[kSums];
    for (int first = 0; first < size_; first += kBlock) {
      const int count = std::min(kBlock, size_ - first);
      for (int k = 0; k < count; ++k) term(first + k, weights_[first + k], terms, k);
      for (std::size_t sum = 0; sum < kSums; ++sum) sums[sum].add(values[sum], count);
    }
    std::array<double, kSums> totals;
    for (std::size_t sum = 0; sum < kSums; ++sum) totals[sum] = sums[sum].total();
    return totals;
  }

  const double* x_;
  const double* y_;
  const double* yaw_;
  const double* weights_;
  int size_;
};

/// The members of a cluster as a set of their own.
struct Members {
  Members(const ParticleSet& particles, const Eigen::ArrayXd& all_weights, const Indices& indices) {
    const auto count = static_cast<Eigen::Index>(indices.size());
    set.resize(count);
    weights.resize(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Index i = indices[static_cast<std::size_t>(k)];
      set.setPose(k, particles.pose(i));
      weights[k] = all_weights[i];
    }
  }
  ParticleSet set;
  Eigen::ArrayXd weights;
};

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

PoseEstimate weightedMean(const ParticleSet& particles, const Eigen::ArrayXd& weights) {
  const WeightedSums sums(particles, weights);
  const Pose2 mean = sums.mean();
  return {mean, sums.covarianceAbout(mean)};
}

PoseEstimate weightedMean(const ParticleSet& particles) {
  return weightedMean(particles, weightsOf(particles));
}

PoseEstimate bestParticle(const ParticleSet& particles, const Eigen::ArrayXd& weights) {
  Eigen::Index best = 0;
  weights.maxCoeff(&best);
  const Pose2 pose = particles.pose(best);
  return {pose, WeightedSums(particles, weights).covarianceAbout(pose)};
}

PoseEstimate bestParticle(const ParticleSet& particles) {
  return bestParticle(particles, weightsOf(particles));
}

std::vector<Cluster> findClusters(const ParticleSet& particles, const PoseBins& bins) {
  return findClusters(particles, weightsOf(particles), bins);
}

std::vector<Cluster> findClusters(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                                  const PoseBins& bins) {
  if (particles.size() > 0 && lieInOnePlace(particles, bins)) {
    return {{weightedMean(particles, weights), 1.0, particles.size()}};
  }
  BinnedParticles unvisited = groupByBin(particles, bins);
  const std::int32_t yaw_bins = yawBinCount(bins);
  const double total = weights.sum();

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
    const Members cluster(particles, weights, members);
    const double weight = cluster.weights.sum();
    if (weight <= 0.0) continue;
    clusters.push_back(
        {weightedMean(cluster.set, cluster.weights), weight / total, cluster.set.size()});
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.weight > b.weight; });
  return clusters;
}

PoseEstimate estimatePose(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                          EstimateFrom from) {
  switch (from) {
    case EstimateFrom::kBest:
      return bestParticle(particles, weights);
    case EstimateFrom::kCluster:
      return findClusters(particles, weights).front().estimate;
    default:
      return weightedMean(particles, weights);
  }
}

PoseEstimate estimatePose(const ParticleSet& particles, EstimateFrom from) {
  return estimatePose(particles, weightsOf(particles), from);
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
