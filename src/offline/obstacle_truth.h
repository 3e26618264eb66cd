// The true obstacles of a simulated drive: poses, velocities, and which of them the lidar sees.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "sim/simulator.h"

namespace racecar_mcl {

/// m, from a point of the map to the obstacle at `in_map`; 0 inside.
inline double distanceTo(const sim::Obstacle& obstacle, const Eigen::Vector2d& point) {
  const Pose2 there = between(obstacle.in_map, {point.x(), point.y(), 0.0});
  if (obstacle.shape == sim::Obstacle::Shape::kDisc) {
    return std::max(0.0, std::hypot(there.x, there.y) - obstacle.radius);
  }
  return std::hypot(std::max(0.0, std::abs(there.x) - obstacle.length / 2.0),
                    std::max(0.0, std::abs(there.y) - obstacle.width / 2.0));
}

/// For each obstacle at its `in_map`, whether it is nearer than 5 m and the part of its outline
/// that the beams of a lidar at this pose hit is at least 0.2 m wide.
inline std::vector<bool> obstaclesInView(const std::vector<sim::Obstacle>& obstacles,
                                         const sim::World& world, const sim::LidarParameters& lidar,
                                         const Pose2& lidar_in_map) {
  constexpr double kMaxRange = 5.0;  // m
  constexpr double kMinWidth = 0.2;  // m
  const Eigen::Vector2d origin(lidar_in_map.x, lidar_in_map.y);
  std::vector<std::vector<Eigen::Vector2d>> hits(obstacles.size());
  for (int beam = 0; beam < lidar.beams; ++beam) {
    const double yaw = lidar_in_map.yaw + lidar.field_of_view * (beam / (lidar.beams - 1.0) - 0.5);
    const Eigen::Vector2d direction(std::cos(yaw), std::sin(yaw));
    double nearest = kMaxRange;
    std::optional<std::size_t> hit;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const double range = sim::castObstacle(obstacles[i], obstacles[i].in_map, origin, direction);
      if (range >= nearest) continue;
      nearest = range;
      hit = i;
    }
    if (!hit || world.castWalls(origin, yaw, nearest) < nearest) continue;
    hits[*hit].emplace_back(origin + nearest * direction);
  }
  std::vector<bool> in_view;
  in_view.reserve(hits.size());
  for (const std::vector<Eigen::Vector2d>& seen : hits) {
    in_view.push_back(!seen.empty() && (seen.back() - seen.front()).norm() >= kMinWidth);
  }
  return in_view;
}

/// The obstacles of the last control steps.
class ObstacleHistory {
 public:
  /// Call it before each control step, once its obstacles are set.
  void add(const sim::Simulator& simulator) {
    steps_.emplace_back(simulator.time(), simulator.obstacles());
    while (steps_.size() > kMaxSteps) steps_.pop_front();
  }

  /// The obstacles at a stamp (s); `in_map` is their pose then.
  std::vector<sim::Obstacle> at(double stamp) const {
    std::vector<sim::Obstacle> obstacles = stepAt(stamp)->second;
    for (sim::Obstacle& obstacle : obstacles) {
      obstacle.in_map = sim::poseAt(obstacle, stamp);
      obstacle.path.clear();
    }
    return obstacles;
  }

  /// Whether the steps after a stamp that `velocity` needs have been added.
  bool covers(double stamp) const { return steps_.end() - stepAt(stamp) > kSteps; }

  /// m/s, map frame: the mean over two control steps before and after a stamp. Precondition: it
  /// covers the stamp, and the obstacles are in the same order in all steps.
  Eigen::Vector2d velocity(std::size_t obstacle, double stamp) const {
    const auto step = stepAt(stamp);
    const auto from = step - std::min(kSteps, step - steps_.begin());
    const auto to = step + kSteps;
    const Pose2 first = sim::poseAt(from->second[obstacle], from->first);
    const Pose2 last = sim::poseAt(to->second[obstacle], to->first);
    return Eigen::Vector2d(last.x - first.x, last.y - first.y) / (to->first - from->first);
  }

 private:
  using Steps = std::deque<std::pair<double, std::vector<sim::Obstacle>>>;
  static constexpr std::size_t kMaxSteps = 20;
  static constexpr std::ptrdiff_t kSteps = 2;

  /// The last control step up to a stamp.
  Steps::const_iterator stepAt(double stamp) const {
    auto step = steps_.end() - 1;
    while (step != steps_.begin() && step->first > stamp) --step;
    return step;
  }

  Steps steps_;  ///< time, s, and obstacles
};

}  // namespace racecar_mcl
