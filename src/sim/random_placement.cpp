#include "sim/random_placement.h"

#include <algorithm>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kMaxWallRange = 12.0;        // m
constexpr double kMaxWallDistance = 0.30;     // m, from the wall to the obstacle's centre
constexpr double kMinPassage = 1.4;           // m, between the obstacle and the opposite wall
constexpr double kMinSpacing = 3.0;           // m, between obstacles and from keep_clear
constexpr double kMinDistanceToOthers = 1.2;  // m, from existing obstacles
constexpr double kPathLength = 2.0;           // m, of moving obstacles
constexpr double kMinWallGap = 0.15;          // m, between a wall and a box
constexpr double kMaxWallGap = 0.40;          // m

struct Wall {
  double yaw = 0.0;  // rad, direction to it
  double range = 0.0;
};

Wall nearestWall(const World& world, const Eigen::Vector2d& point) {
  Wall nearest{0.0, kMaxWallRange};
  for (int i = 0; i < 72; ++i) {
    const double yaw = 2.0 * kPi * i / 72.0;
    const double range = world.castWalls(point, yaw, nearest.range, Ends::kWhereNotFree);
    if (range < nearest.range) nearest = {yaw, range};
  }
  return nearest;
}

/// Whether an obstacle of radius `half` at `point` next to the wall leaves a passage.
bool leavesPassage(const World& world, const Eigen::Vector2d& point, double wall_yaw, double half) {
  const auto freeTowards = [&](double yaw) {
    return world.castWalls(point, yaw, kMaxWallRange, Ends::kWhereNotFree);
  };
  return world.isFree(point) && freeTowards(wall_yaw) <= kMaxWallDistance &&
         freeTowards(wall_yaw + kPi) >= half + kMinPassage;
}

Obstacle drawObstacle(const Eigen::Vector2d& point, double yaw, Random& random) {
  Obstacle obstacle;
  obstacle.shape = random.uniform() < 0.5 ? Obstacle::Shape::kDisc : Obstacle::Shape::kBox;
  obstacle.radius = random.uniform(0.08, 0.20);
  obstacle.length = random.uniform(0.15, 0.50);
  obstacle.width = random.uniform(0.15, 0.40);
  obstacle.in_map = {point.x(), point.y(), yaw};
  return obstacle;
}

}  // namespace

Pose2 randomFreePose(const World& world, const CarParameters& car, Random& random,
                     double clearance) {
  for (int attempt = 0; attempt < kPlacementAttempts; ++attempt) {
    const Eigen::Vector2d point = world.randomFreePoint(random);
    const Pose2 base_in_map{point.x(), point.y(), wrapAngle(random.uniform(-kPi, kPi))};
    if (!overlaps(base_in_map, car, world, {}, 0.0, clearance)) return base_in_map;
  }
  throw MapError("the world has no room for the car: " + std::to_string(kPlacementAttempts) +
                 " random poses were not free");
}

std::vector<Obstacle> placeBoxes(const World& world, int count, const Pose2& keep_clear,
                                 Random& random) {
  std::vector<Obstacle> boxes;
  for (int attempt = 0; attempt < kPlacementAttempts && static_cast<int>(boxes.size()) < count;
       ++attempt) {
    const Eigen::Vector2d point = world.randomFreePoint(random);
    const Wall wall = nearestWall(world, point);
    Obstacle box;
    box.shape = Obstacle::Shape::kBox;
    box.length = random.uniform(0.25, 0.45);
    box.width = random.uniform(0.25, 0.35);
    box.in_map = {point.x(), point.y(), wrapAngle(random.uniform(-kPi, kPi))};
    const double half = std::hypot(box.length, box.width) / 2.0;
    const double opposite =
        world.castWalls(point, wall.yaw + kPi, kMaxWallRange, Ends::kWhereNotFree);
    const bool fits = wall.range >= half + kMinWallGap && wall.range <= half + kMaxWallGap &&
                      opposite >= half + kMinPassage &&
                      distance(box.in_map, keep_clear) > kMinSpacing &&
                      std::all_of(boxes.begin(), boxes.end(), [&](const Obstacle& other) {
                        return distance(box.in_map, other.in_map) > kMinSpacing;
                      });
    if (fits) boxes.push_back(box);
  }
  return boxes;
}

std::vector<Obstacle> scatterObstacles(const World& world, int count, int moving,
                                       const Pose2& keep_clear, Random& random,
                                       const std::vector<Obstacle>& others) {
  std::vector<Obstacle> obstacles;
  for (int attempt = 0; attempt < kPlacementAttempts; ++attempt) {
    if (static_cast<int>(obstacles.size()) >= count) return obstacles;
    const bool moves = static_cast<int>(obstacles.size()) < moving;
    const Eigen::Vector2d point = world.randomFreePoint(random);
    const Wall wall = nearestWall(world, point);
    const double along = wall.yaw + kPi / 2.0;
    Obstacle obstacle = drawObstacle(point, along, random);
    const double speed = random.uniform(0.4, 1.2);

    const Eigen::Vector2d direction(std::cos(along), std::sin(along));
    const double half = std::max({obstacle.radius, obstacle.width / 2.0, obstacle.length / 2.0});
    bool fits = true;
    for (double way = 0.0; fits && way <= (moves ? kPathLength : 0.0); way += 0.1) {
      const Eigen::Vector2d there = point + way * direction;
      fits = leavesPassage(world, there, wall.yaw, half) &&
             std::all_of(others.begin(), others.end(), [&](const Obstacle& other) {
               const Eigen::Vector2d place(other.in_map.x, other.in_map.y);
               return (there - place).norm() > kMinDistanceToOthers;
             });
    }
    const auto isFar = [&](const Pose2& other, double walk) {
      return distance(obstacle.in_map, other) > kMinSpacing + walk + (moves ? kPathLength : 0.0);
    };
    fits = fits && isFar(keep_clear, 0.0);
    for (const Obstacle& other : obstacles) {
      fits = fits && isFar(other.in_map, other.path.empty() ? 0.0 : kPathLength);
    }
    if (!fits) continue;
    if (moves) {
      obstacle.path = {point, point + kPathLength * direction};
      obstacle.speed = speed;
    }
    obstacles.push_back(obstacle);
  }
  throw MapError("the world has room for " + std::to_string(obstacles.size()) + " of " +
                 std::to_string(count) + " obstacles that leave a passage for the car");
}

}  // namespace racecar_mcl::sim
