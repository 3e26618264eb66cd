#include "racecar_mcl/scan/deskew.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

// Between poses of the lidar that are computed. At 7 m/s and 3 rad/s the interpolated position is
// off by 3 micrometres.
constexpr double kPosePeriod = 1e-3;  // s

/// The pose of the lidar during a sweep, in its frame at the stamp.
class LidarMotion {
 public:
  LidarMotion(const Scan& scan, const BaseAfter& base_after)
      : first_(static_cast<double>(scan.seconds_after_stamp.minCoeff())) {
    const double duration = static_cast<double>(scan.seconds_after_stamp.maxCoeff()) - first_;
    const double periods =
        std::clamp(std::ceil(duration / kPosePeriod), 1.0, static_cast<double>(scan.size()));
    poses_.reserve(static_cast<std::size_t>(periods) + 1);
    const Pose2 base_in_laser = inverse(scan.laser_in_base);
    for (int i = 0; i <= static_cast<int>(periods); ++i) {
      const Pose2 base = base_after(first_ + duration * i / periods);
      Pose2 laser = compose(compose(base_in_laser, base), scan.laser_in_base);
      if (i > 0) laser.yaw = poses_.back().yaw + wrapAngle(laser.yaw - poses_.back().yaw);
      poses_.push_back(laser);
    }
    per_second_ = duration > 0.0 ? periods / duration : 0.0;
  }

  Pose2 at(double seconds) const {
    const double position = (seconds - first_) * per_second_;
    const std::size_t i = std::min(static_cast<std::size_t>(position), poses_.size() - 2);
    const double part = position - static_cast<double>(i);
    const Pose2& before = poses_[i];
    const Pose2& after = poses_[i + 1];
    return {before.x + part * (after.x - before.x), before.y + part * (after.y - before.y),
            before.yaw + part * (after.yaw - before.yaw)};
  }

 private:
  double first_;       ///< s after the stamp
  double per_second_;  ///< poses
  std::vector<Pose2> poses_;
};

/// The angle of a point, rad; a series for the points near the x axis.
double angleOf(double x, double y) {
  const double t = y / x;
  if (!(x > 0.0 && std::abs(t) < 0.1)) return std::atan2(y, x);
  const double t2 = t * t;
  return t * (1.0 - t2 * (1.0 / 3.0 - t2 * (1.0 / 5.0 - t2 * (1.0 / 7.0 - t2 * (1.0 / 9.0)))));
}

}  // namespace

Scan deskew(const Scan& scan, const BaseAfter& base_after) {
  Scan deskewed = scan;
  if (scan.size() == 0) return deskewed;
  const LidarMotion motion(scan, base_after);
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const Pose2 laser = motion.at(static_cast<double>(scan.seconds_after_stamp[i]));
    const double bearing = laser.yaw + static_cast<double>(scan.bearings[i]);
    if (!std::isfinite(scan.ranges[i])) {
      deskewed.bearings[i] = static_cast<float>(wrapAngle(bearing));
      continue;
    }
    double sine, cosine;
    sinCos(bearing, &sine, &cosine);
    // The end point, along and across the beam.
    const double along = static_cast<double>(scan.ranges[i]) + laser.x * cosine + laser.y * sine;
    const double across = laser.y * cosine - laser.x * sine;
    deskewed.bearings[i] = static_cast<float>(wrapAngle(bearing + angleOf(along, across)));
    deskewed.ranges[i] = static_cast<float>(std::sqrt(along * along + across * across));
  }
  deskewed.seconds_after_stamp.setZero();
  return deskewed;
}

}  // namespace racecar_mcl
