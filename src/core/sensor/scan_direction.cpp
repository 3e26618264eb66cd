#include "racecar_mcl/sensor/scan_direction.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

// Minimum turn during a sweep (docs/maths.md): less distorts it by less than scans resolve.
constexpr double kMinTurn = 0.02;  // rad

// Log odds: limit per radian turned, since the scans of one turn have correlated errors; below
// which the order changes; above which the order is certain.
constexpr double kMaxLogOddsPerRadian = 5.0;
constexpr double kChangeLogOdds = -6.0;
constexpr double kCertainLogOdds = 20.0;

}  // namespace

Scan mirroredInTime(Scan scan) {
  Eigen::ArrayXf& seconds = scan.seconds_after_stamp;
  if (seconds.size() > 0) seconds = seconds.minCoeff() + seconds.maxCoeff() - seconds;
  return scan;
}

double scanLogOdds(const LikelihoodField& field, const Pose2& base_in_map, const Scan& one,
                   const Scan& other) {
  const auto logLikelihood = [&](const Scan& scan) {
    const Pose2 lidar = compose(base_in_map, scan.laser_in_base);
    Eigen::ArrayXd value(1);
    field.logLikelihood(batchOf(lidar), scan, value);
    return value[0];
  };
  return logLikelihood(one) - logLikelihood(other);
}

bool ScanDirection::needsComparison(double turned) const {
  return from_ == ScanDirectionFrom::kAuto && certainty_ < kCertainLogOdds &&
         std::abs(turned) > kMinTurn;
}

bool ScanDirection::learn(double log_odds, double turned) {
  if (!std::isfinite(log_odds)) return false;
  const double limit = kMaxLogOddsPerRadian * std::abs(turned);
  certainty_ += std::clamp(log_odds, -limit, limit);
  if (certainty_ > kChangeLogOdds) return false;
  reversed_ = !reversed_;
  certainty_ = 0.0;
  return true;
}

}  // namespace racecar_mcl
