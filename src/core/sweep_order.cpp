#include "racecar_mcl/sweep_order.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

// rad, during a sweep. Less bends a sweep by less than scans tell.
constexpr double kTurned = 0.02;

// Log odds: what a radian turned during sweeps may say at most, for the scans of one turn err
// alike; against the order of now, from which on it is changed; in its favour, from which on
// nothing is asked any more.
constexpr double kMostByRadian = 5.0;
constexpr double kChange = -6.0;
constexpr double kCertain = 20.0;

}  // namespace

Scan mirroredInTime(Scan scan) {
  Eigen::ArrayXf& seconds = scan.seconds_after_stamp;
  if (seconds.size() > 0) seconds = seconds.minCoeff() + seconds.maxCoeff() - seconds;
  return scan;
}

double logOddsOfScans(const LikelihoodField& field, const Pose2& base_in_map, const Scan& one,
                      const Scan& other) {
  const auto logLikelihood = [&](const Scan& scan) {
    const Pose2 lidar = compose(base_in_map, scan.laser_in_base);
    Eigen::ArrayXd value(1);
    field.logLikelihood({&lidar.x, &lidar.y, &lidar.yaw, 1}, scan, value);
    return value[0];
  };
  return logLikelihood(one) - logLikelihood(other);
}

Scan SweepOrder::inOrderTaken(Scan scan) const {
  if (reversed_) scan.seconds_after_stamp = -scan.seconds_after_stamp;
  return scan;
}

bool SweepOrder::wantsToCompare(double turned) const {
  return from_ == SweepOrderFrom::kLearned && certainty_ < kCertain && std::abs(turned) > kTurned;
}

bool SweepOrder::learn(double log_odds, double turned) {
  if (!std::isfinite(log_odds)) return false;
  const double most = kMostByRadian * std::abs(turned);
  certainty_ += std::clamp(log_odds, -most, most);
  if (certainty_ > kChange) return false;
  reversed_ = !reversed_;
  certainty_ = 0.0;
  return true;
}

}  // namespace racecar_mcl
