#include "racecar_mcl/filter/pose_estimate.h"

#include <algorithm>
#include <array>

#include "racecar_mcl/filter/clustering.h"
#include "racecar_mcl/filter/point_covariance.h"
#include "racecar_mcl/filter/resampling.h"
#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

// Mean resultant length below which the circular mean of the yaws is undefined.
constexpr double kMinResultantLength = 1e-9;

/// Weighted sums over poses; the order of summation does not depend on the instruction set.
class WeightedSums {
 public:
  WeightedSums(const PoseBatch& poses, const double* weights)
      : x_(poses.x),
        y_(poses.y),
        yaw_(poses.yaw),
        weights_(weights),
        size_(static_cast<int>(poses.size)) {}

  Pose2 mean() const {
    // Sums relative to the first particle stay precise far from the map's origin.
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
    const bool cancels = std::hypot(sine, cosine) < kMinResultantLength;
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
  /// `term(i, weight, terms, k)` writes the contribution of pose i to each sum to terms[sum][k].
  template <std::size_t kSums, typename Term>
  RACECAR_MCL_INLINE std::array<double, kSums> sumTerms(const Term& term) const {
    alignas(64) double values[kSums][kBlockSize];
    double* terms[kSums];
    for (std::size_t sum = 0; sum < kSums; ++sum) terms[sum] = values[sum];
    LaneSum sums[kSums];
    for (int first = 0; first < size_; first += kBlockSize) {
      const int count = std::min(kBlockSize, size_ - first);
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

}  // namespace

double positionSigma(const PoseEstimate& estimate) {
  return majorSigma(estimate.covariance.topLeftCorner<2, 2>());
}

PoseEstimate weightedMean(const PoseBatch& poses, const double* weights) {
  const WeightedSums sums(poses, weights);
  const Pose2 mean = sums.mean();
  return {mean, sums.covarianceAbout(mean)};
}

PoseEstimate weightedMean(const ParticleSet& particles, const Eigen::ArrayXd& weights) {
  return weightedMean(particles.poses(), weights.data());
}

PoseEstimate weightedMean(const ParticleSet& particles) {
  return weightedMean(particles, weightsOf(particles));
}

PoseEstimate bestParticle(const ParticleSet& particles, const Eigen::ArrayXd& weights) {
  Eigen::Index best = 0;
  weights.maxCoeff(&best);
  const Pose2 pose = particles.pose(best);
  return {pose, WeightedSums(particles.poses(), weights.data()).covarianceAbout(pose)};
}

PoseEstimate bestParticle(const ParticleSet& particles) {
  return bestParticle(particles, weightsOf(particles));
}

PoseEstimate estimatePose(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                          EstimateFrom from) {
  switch (from) {
    case EstimateFrom::kBest:
      return bestParticle(particles, weights);
    case EstimateFrom::kCluster:
      return ClusterFinder().find(particles, weights).front().estimate;
    default:
      return weightedMean(particles, weights);
  }
}

PoseEstimate estimatePose(const ParticleSet& particles, EstimateFrom from) {
  return estimatePose(particles, weightsOf(particles), from);
}

PoseEstimate propagate(const PoseEstimate& estimate, const Pose2& delta,
                       const Eigen::Matrix3d& noise) {
  const double c = std::cos(estimate.base_in_map.yaw);
  const double s = std::sin(estimate.base_in_map.yaw);
  Eigen::Matrix3d pose_jacobian = Eigen::Matrix3d::Identity();
  pose_jacobian(0, 2) = -s * delta.x - c * delta.y;
  pose_jacobian(1, 2) = c * delta.x - s * delta.y;
  Eigen::Matrix3d noise_jacobian = Eigen::Matrix3d::Identity();
  noise_jacobian.topLeftCorner<2, 2>() << c, -s, s, c;
  return {compose(estimate.base_in_map, delta),
          pose_jacobian * estimate.covariance * pose_jacobian.transpose() +
              noise_jacobian * noise * noise_jacobian.transpose()};
}

}  // namespace racecar_mcl
