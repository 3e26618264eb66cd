#include "sim/obstacle.h"

#include <algorithm>

#include "racecar_mcl/common/validation.h"
#include "sim/infinity.h"

namespace racecar_mcl::sim {
namespace {

double castDisc(double radius, const Eigen::Vector2d& start, const Eigen::Vector2d& direction) {
  // |start + t direction|^2 = radius^2
  const double b = start.dot(direction);
  const double c = start.squaredNorm() - radius * radius;
  if (c <= 0.0) return 0.0;
  const double discriminant = b * b - c;
  if (b >= 0.0 || discriminant < 0.0) return kInfinity;
  return c / (-b + std::sqrt(discriminant));
}

double castBox(double length, double width, const Eigen::Vector2d& start,
               const Eigen::Vector2d& direction) {
  const Eigen::Vector2d half(length / 2.0, width / 2.0);
  double enter = 0.0;
  double leave = kInfinity;
  for (int axis = 0; axis < 2; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(start[axis]) > half[axis]) return kInfinity;
      continue;
    }
    const double a = (-half[axis] - start[axis]) / direction[axis];
    const double b = (half[axis] - start[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : kInfinity;
}

}  // namespace

void Obstacle::validate() const {
  if (shape == Shape::kDisc) requirePositive("obstacle radius", radius, "m");
  if (shape == Shape::kBox) {
    requirePositive("obstacle length", length, "m");
    requirePositive("obstacle width", width, "m");
  }
  requireNotNegative("obstacle speed", speed, "m/s");
  requireFinite("obstacle start time", start_time, "s");
  requireFinite("obstacle x", in_map.x, "m");
  requireFinite("obstacle y", in_map.y, "m");
  requireFinite("obstacle yaw", in_map.yaw, "rad");
  for (const Eigen::Vector2d& point : path) {
    requireFinite("obstacle path x", point.x(), "m");
    requireFinite("obstacle path y", point.y(), "m");
  }
}

Pose2 poseAt(const Obstacle& obstacle, double time) {
  if (obstacle.path.empty()) return obstacle.in_map;
  const std::vector<Eigen::Vector2d>& path = obstacle.path;
  double total = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) total += (path[i] - path[i - 1]).norm();
  if (total == 0.0) return {path.front().x(), path.front().y(), obstacle.in_map.yaw};

  // One period is 2 total; the second half runs backwards.
  double along = std::fmod(obstacle.speed * std::max(time - obstacle.start_time, 0.0), 2.0 * total);
  const bool back = along > total;
  if (back) along = 2.0 * total - along;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d leg = path[i] - path[i - 1];
    const double length = leg.norm();
    if (along > length && i + 1 < path.size()) {
      along -= length;
      continue;
    }
    const Eigen::Vector2d point =
        length > 0.0 ? path[i - 1] + leg * (std::min(along, length) / length) : path[i];
    return {point.x(), point.y(), wrapAngle(std::atan2(leg.y(), leg.x()) + (back ? kPi : 0.0))};
  }
  return {path.back().x(), path.back().y(), obstacle.in_map.yaw};
}

double castObstacle(const Obstacle& obstacle, const Pose2& obstacle_in_map,
                    const Eigen::Vector2d& origin, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d start = origin - Eigen::Vector2d(obstacle_in_map.x, obstacle_in_map.y);
  if (obstacle.shape == Obstacle::Shape::kDisc) return castDisc(obstacle.radius, start, direction);
  // Most rays miss the circumscribed circle: early exit before rotating into the box frame.
  const double reach = std::hypot(obstacle.length, obstacle.width) / 2.0;
  if (std::abs(start.x() * direction.y() - start.y() * direction.x()) > reach) return kInfinity;
  const double c = std::cos(obstacle_in_map.yaw);
  const double s = std::sin(obstacle_in_map.yaw);
  const auto toBoxFrame = [&](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(c * v.x() + s * v.y(), c * v.y() - s * v.x());
  };
  return castBox(obstacle.length, obstacle.width, toBoxFrame(start), toBoxFrame(direction));
}

}  // namespace racecar_mcl::sim
