#include "racecar_mcl/monitoring/protection_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

// The factors were chosen on simulated drives and recordings (docs/maths.md).

// Factor on the standard deviations of the estimate: scans repeat the errors of the map's cells,
// but the filter counts them as independent.
constexpr double kSigmaFactor = 1.5;
// Heading error per position error of the map's surfaces, rad/m.
constexpr double kHeadingPerMapError = 0.15;
// Drift of lidar odometry.
constexpr double kDriftPerMetre = 0.05;         // m per m
constexpr double kHeadingDriftPerMetre = 3e-3;  // rad per m

/// The value whose magnitude a standard normal variable exceeds with this probability (Abramowitz
/// and Stegun, 26.2.23; error below 5e-4).
double twoSidedQuantile(double probability) {
  const double t = std::sqrt(-2.0 * std::log(0.5 * probability));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                 (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

}  // namespace

void validate(const ProtectionLevelParameters& p) {
  require(p.integrity_risk > 0.0 && p.integrity_risk <= 0.5, "integrity_risk", p.integrity_risk,
          "above 0 and at most 0.5");
}

ProtectionLevel unboundedLevel() {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  return {kUnbounded, kUnbounded, kPi};
}

ProtectionLevel protectionLevel(const ProtectionLevelParameters& parameters,
                                const PoseEstimate& estimate, const ScanMatch& match,
                                double carried) {
  const double yaw = estimate.base_in_map.yaw;
  const Eigen::Vector3d along(std::cos(yaw), std::sin(yaw), 0.0);
  const Eigen::Vector3d across(-std::sin(yaw), std::cos(yaw), 0.0);
  const Eigen::Matrix3d& covariance = estimate.covariance;
  const double quantile = twoSidedQuantile(parameters.integrity_risk);
  const auto level = [&](double variance, double map_error) {
    const double scaled = kSigmaFactor * kSigmaFactor * std::max(0.0, variance);
    return quantile * std::sqrt(scaled + map_error * map_error);
  };
  const double drift = kDriftPerMetre * carried;
  return {level(along.dot(covariance * along), match.map_error) + drift,
          level(across.dot(covariance * across), match.map_error) + drift,
          std::min(kPi, level(covariance(2, 2), kHeadingPerMapError * match.map_error) +
                            kHeadingDriftPerMetre * carried)};
}

}  // namespace racecar_mcl
