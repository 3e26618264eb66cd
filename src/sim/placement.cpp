#include "sim/placement.h"

#include <algorithm>

#include "racecar_mcl/errors.h"

namespace racecar_mcl::sim {
namespace {

constexpr int kAttempts = 20000;
constexpr double kReach = 12.0;       // m, how far walls are looked for
constexpr double kBesideWall = 0.30;  // m, wall to the obstacle's centre at most
constexpr double kPassage = 1.4;      // m, left free between the obstacle and what is opposite
constexpr double kApart = 3.0;        // m, between obstacles, and from what is to be kept clear
constexpr double kFromOthers = 1.2;   // m, from what stands already
constexpr double kWalk = 2.0;         // m, length of a moving obstacle's path
constexpr double kOffWall = 0.15;     // m, between a wall and a box that stands free, at least
constexpr double kNearWall = 0.40;    // m, at most

struct Wall {
  double yaw = 0.0;  // rad, direction to it
  double range = 0.0;
};

Wall nearestWall(const World& world, const Eigen::Vector2d& point) {
  Wall nearest{0.0, kReach};
  for (int i = 0; i < 72; ++i) {
    const double yaw = 2.0 * kPi * i / 72.0;
    const double range = world.castWalls(point, yaw, nearest.range, Ends::kWhereNotFree);
    if (range < nearest.range) nearest = {yaw, range};
  }
  return nearest;
}

/// Whether something `half` m thick can stand at `point` beside the wall and leaves a way past.
bool leavesPassage(const World& world, const Eigen::Vector2d& point, double wall_yaw, double half) {
  const auto freeTowards = [&](double yaw) {
    return world.castWalls(point, yaw, kReach, Ends::kWhereNotFree);
  };
  return world.isFree(point) && freeTowards(wall_yaw) <= kBesideWall &&
         freeTowards(wall_yaw + kPi) >= half + kPassage;
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
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Eigen::Vector2d point = world.randomFreePoint(random);
    const Pose2 base_in_map{point.x(), point.y(), wrapAngle(random.uniform(-kPi, kPi))};
    if (!overlaps(base_in_map, car, world, {}, 0.0, clearance)) return base_in_map;
  }
  throw MapError("the world has no room for the car: " + std::to_string(kAttempts) +
                 " random poses all touch a wall");
}

std::vector<Obstacle> standBoxes(const World& world, int count, const Pose2& keep_clear,
                                 Random& random) {
  std::vector<Obstacle> boxes;
  for (int attempt = 0; attempt < kAttempts && static_cast<int>(boxes.size()) < count; ++attempt) {
    const Eigen::Vector2d point = world.randomFreePoint(random);
    const Wall wall = nearestWall(world, point);
    Obstacle box;
    box.shape = Obstacle::Shape::kBox;
    box.length = random.uniform(0.25, 0.45);
    box.width = random.uniform(0.25, 0.35);
    box.in_map = {point.x(), point.y(), wrapAngle(random.uniform(-kPi, kPi))};
    const double half = std::hypot(box.length, box.width) / 2.0;
    const double opposite = world.castWalls(point, wall.yaw + kPi, kReach, Ends::kWhereNotFree);
    const bool fits = wall.range >= half + kOffWall && wall.range <= half + kNearWall &&
                      opposite >= half + kPassage && distance(box.in_map, keep_clear) > kApart &&
                      std::all_of(boxes.begin(), boxes.end(), [&](const Obstacle& other) {
                        return distance(box.in_map, other.in_map) > kApart;
                      });
    if (fits) boxes.push_back(box);
  }
  return boxes;
}

std::vector<Obstacle> scatterObstacles(const World& world, int count, int moving,
                                       const Pose2& keep_clear, Random& random,
                                       const std::vector<Obstacle>& others) {
  std::vector<Obstacle> obstacles;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (static_cast<int>(obstacles.size()) >= count) return obstacles;
    const bool walks = static_cast<int>(obstacles.size()) < moving;
    const Eigen::Vector2d point = world.randomFreePoint(random);
    const Wall wall = nearestWall(world, point);
    const double along = wall.yaw + kPi / 2.0;
    Obstacle obstacle = drawObstacle(point, along, random);
    const double speed = random.uniform(0.4, 1.2);

    const Eigen::Vector2d direction(std::cos(along), std::sin(along));
    const double half = std::max({obstacle.radius, obstacle.width / 2.0, obstacle.length / 2.0});
    bool fits = true;
    for (double way = 0.0; fits && way <= (walks ? kWalk : 0.0); way += 0.1) {
      const Eigen::Vector2d there = point + way * direction;
      fits = leavesPassage(world, there, wall.yaw, half) &&
             std::all_of(others.begin(), others.end(), [&](const Obstacle& other) {
               const Eigen::Vector2d place(other.in_map.x, other.in_map.y);
               return (there - place).norm() > kFromOthers;
             });
    }
    const auto isFar = [&](const Pose2& other, double walk) {
      return distance(obstacle.in_map, other) > kApart + walk + (walks ? kWalk : 0.0);
    };
    fits = fits && isFar(keep_clear, 0.0);
    for (const Obstacle& other : obstacles) {
      fits = fits && isFar(other.in_map, other.path.empty() ? 0.0 : kWalk);
    }
    if (!fits) continue;
    if (walks) {
      obstacle.path = {point, point + kWalk * direction};
      obstacle.speed = speed;
    }
    obstacles.push_back(obstacle);
  }
  throw MapError("the world has room for " + std::to_string(obstacles.size()) + " of " +
                 std::to_string(count) + " obstacles that leave the car a way past");
}

}  // namespace racecar_mcl::sim
