#include "racecar_mcl/protection_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

// Errors have heavier tails than the Gaussian of the covariance: its quantile is widened by this.
constexpr double kTails = 1.5;
// How much of the beams' distance from the surfaces the map's own error is, which moves the pose.
constexpr double kMapShare = 0.45;
constexpr double kHeadingPerMetre = 0.1;  // rad of heading per m of the map's error
// Drift of a pose carried by lidar odometry.
constexpr double kDriftPerMetre = 0.03;         // m per m
constexpr double kHeadingDriftPerMetre = 2e-3;  // rad per m

/// The value that a standard normal variable exceeds in magnitude with this probability
/// (Abramowitz and Stegun, 26.2.23; to 5e-4).
double twoSidedQuantile(double probability) {
  const double t = std::sqrt(-2.0 * std::log(0.5 * probability));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                 (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

}  // namespace

void validate(const ProtectionLevelParameters& p) {
  require(p.protection_risk > 0.0 && p.protection_risk <= 0.5, "protection_risk", p.protection_risk,
          "above 0 and at most 0.5");
}

ProtectionLevel unboundedLevel() {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  return {kUnbounded, kUnbounded, kPi};
}

ProtectionLevel protectionLevel(const ProtectionLevelParameters& parameters,
                                const PoseEstimate& estimate, const ScanFit& fit, double carried) {
  const double yaw = estimate.base_in_map.yaw;
  const Eigen::Vector3d along(std::cos(yaw), std::sin(yaw), 0.0);
  const Eigen::Vector3d across(-std::sin(yaw), std::cos(yaw), 0.0);
  const Eigen::Matrix3d& covariance = estimate.covariance;
  const double map_error = kMapShare * fit.residual;
  const double factor = kTails * twoSidedQuantile(parameters.protection_risk);
  const auto level = [&](double variance, double error) {
    return factor * std::sqrt(std::max(0.0, variance) + error * error);
  };
  const double drift = kDriftPerMetre * carried;
  return {level(along.dot(covariance * along), map_error) + drift,
          level(across.dot(covariance * across), map_error) + drift,
          std::min(kPi, level(covariance(2, 2), kHeadingPerMetre * map_error) +
                            kHeadingDriftPerMetre * carried)};
}

}  // namespace racecar_mcl
