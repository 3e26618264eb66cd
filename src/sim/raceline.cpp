#include "sim/raceline.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kCurvatureSpan = 0.3;  // m, to either side of a point
constexpr std::size_t kMinPoints = 8;

/// Of the circle through three points (Menger), 1/m.
double curvatureOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d ab = b - a;
  const Eigen::Vector2d bc = c - b;
  const double cross = ab.x() * bc.y() - ab.y() * bc.x();
  return 2.0 * std::abs(cross) / (ab.norm() * bc.norm() * (c - a).norm());
}

/// m/s^2, what the friction circle leaves for the longitudinal direction.
double longitudinalGrip(double speed, double curvature, double grip) {
  const double lateral = speed * speed * curvature;
  return std::sqrt(std::max(0.0, grip * grip - lateral * lateral));
}

}  // namespace

void SpeedLimits::validate() const {
  requirePositive("max_speed", max_speed, "m/s");
  requirePositive("grip", grip, "m/s^2");
  requirePositive("max_acceleration", max_acceleration, "m/s^2");
  requirePositive("max_deceleration", max_deceleration, "m/s^2");
}

Raceline::Raceline(Path path, const SpeedLimits& limits) : path_(std::move(path)) {
  limits.validate();
  require(path_.size() >= kMinPoints, "number of points of the raceline", path_.size(),
          "at least 8");
  const std::size_t count = path_.size();
  double length = 0.0;
  for (std::size_t i = 0; i < count; ++i) ends_.push_back(length += segmentLength(i));

  std::vector<double> curvatures;
  for (std::size_t i = 0; i < count; ++i) {
    const double along = ends_[i] - segmentLength(i);
    const Pose2 before = poseAt(along - kCurvatureSpan);
    const Pose2 ahead = poseAt(along + kCurvatureSpan);
    curvatures.push_back(curvatureOf({before.x, before.y}, path_[i], {ahead.x, ahead.y}));
    speeds_.push_back(std::min(limits.max_speed, std::sqrt(limits.grip / curvatures.back())));
  }
  // v(s)^2 <= v(s')^2 + 2 a |s - s'|, twice around, since the profile is closed.
  const auto limit = [&](std::size_t to, std::size_t from, double way, double max_acceleration) {
    const double acceleration =
        std::min(max_acceleration, longitudinalGrip(speeds_[from], curvatures[from], limits.grip));
    speeds_[to] =
        std::min(speeds_[to], std::sqrt(speeds_[from] * speeds_[from] + 2.0 * acceleration * way));
  };
  for (std::size_t k = 2 * count; k-- > 0;) {
    const std::size_t i = k % count;
    limit(i, after(i), segmentLength(i), limits.max_deceleration);
  }
  for (std::size_t k = 0; k < 2 * count; ++k) {
    const std::size_t i = k % count;
    limit(after(i), i, segmentLength(i), limits.max_acceleration);
  }
}

double Raceline::maxSpeed() const { return *std::max_element(speeds_.begin(), speeds_.end()); }

double Raceline::minSpeed() const { return *std::min_element(speeds_.begin(), speeds_.end()); }

Raceline::Position Raceline::positionAt(double along) const {
  const double wrapped = along - std::floor(along / length()) * length();
  const auto end = std::upper_bound(ends_.begin(), ends_.end() - 1, wrapped);
  const auto i = static_cast<std::size_t>(end - ends_.begin());
  return {i, 1.0 - (*end - wrapped) / segmentLength(i)};
}

Pose2 Raceline::poseAt(double along) const {
  const auto [i, fraction] = positionAt(along);
  const Eigen::Vector2d way = path_[after(i)] - path_[i];
  const Eigen::Vector2d point = path_[i] + fraction * way;
  return {point.x(), point.y(), std::atan2(way.y(), way.x())};
}

double Raceline::speedAt(double along) const {
  const auto [i, fraction] = positionAt(along);
  return (1.0 - fraction) * speeds_[i] + fraction * speeds_[after(i)];
}

Raceline::Place Raceline::placeOf(const Eigen::Vector2d& point_in_map) const {
  Place nearest;
  double squared = HUGE_VAL;
  for (std::size_t i = 0; i < path_.size(); ++i) {
    const Eigen::Vector2d way = path_[after(i)] - path_[i];
    const Eigen::Vector2d offset = point_in_map - path_[i];
    const double fraction = std::clamp(offset.dot(way) / way.squaredNorm(), 0.0, 1.0);
    const double distance = (offset - fraction * way).squaredNorm();
    if (distance >= squared) continue;
    squared = distance;
    const double side = way.x() * offset.y() - way.y() * offset.x();
    nearest = {ends_[i] - (1.0 - fraction) * way.norm(), std::copysign(std::sqrt(distance), side)};
  }
  return nearest;
}

}  // namespace racecar_mcl::sim
