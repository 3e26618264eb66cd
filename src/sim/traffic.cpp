#include "sim/traffic.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/errors.h"
#include "sim/random_placement.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kAreaPerWalker = 8.0;  // m^2
constexpr double kMinWalkers = 5.0;
constexpr double kMaxWalkers = 80.0;
constexpr double kMinDistanceToStart = 1.5;  // m
constexpr double kMinPathLength = 1.5;       // m
constexpr double kMinDistanceToCar = 0.6;    // m, between centres
constexpr double kAhead = 1.15;              // m, between the centres of both cars
constexpr double kBeside = 0.62;             // m
constexpr double kMaxAngle = 1.75;           // rad, bearing from our car
constexpr double kSwayAmplitude = 1.35;      // rad
constexpr double kSwayPeriod = 8.0;          // s
constexpr double kAngularSpeed = 1.2;        // rad/s
const Pose2 kCentreInBase{(CarParameters().length_ahead - CarParameters().length_behind) / 2.0, 0.0,
                          0.0};

double distanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                         const Eigen::Vector2d& to) {
  const Eigen::Vector2d way = to - from;
  const double fraction = std::clamp((point - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (from + fraction * way - point).norm();
}

/// The opponent's pose at a bearing of `angle` from our car, with the same heading.
Pose2 opponentAt(const Pose2& base_in_map, double angle) {
  return compose(base_in_map, {kAhead * std::cos(angle), kBeside * std::sin(angle), 0.0});
}

}  // namespace

Crowd::Crowd(const World& world, const Pose2& keep_clear, Random& random) {
  const auto count = static_cast<std::size_t>(
      std::clamp(world.freeArea() / kAreaPerWalker, kMinWalkers, kMaxWalkers));
  for (int attempt = 0; attempt < kPlacementAttempts && walkers_.size() < count; ++attempt) {
    const Eigen::Vector2d from = world.randomFreePoint(random);
    const double yaw = random.uniform(-kPi, kPi);
    const double radius = random.uniform(0.12, 0.22);
    const double speed = random.uniform(0.4, 1.4);
    const double desired = random.uniform(2.0, 6.0);
    const double start = random.uniform();
    const double length =
        std::min(desired, world.castWalls(from, yaw, desired, Ends::kWhereNotFree) - radius);
    if (length < kMinPathLength) continue;
    const Eigen::Vector2d direction(std::cos(yaw), std::sin(yaw));
    const Walker walker{from, direction, length, start * length, speed, radius};
    if (distanceToSegment({keep_clear.x, keep_clear.y}, from, walker.at(length)) <
        kMinDistanceToStart) {
      continue;
    }
    walkers_.push_back(walker);
  }
  if (walkers_.size() == count) return;
  throw MapError("the world has room for " + std::to_string(walkers_.size()) + " of a crowd of " +
                 std::to_string(count));
}

std::vector<Obstacle> Crowd::walk(const Pose2& base_in_map, double time) {
  const double seconds = time - last_time_.value_or(time);
  last_time_ = time;
  const Pose2 centre = compose(base_in_map, kCentreInBase);
  const Eigen::Vector2d car(centre.x, centre.y);
  std::vector<Obstacle> crowd;
  for (Walker& walker : walkers_) {
    const double next = walker.along + walker.speed * seconds;
    const double distance = (walker.at(next) - car).norm();
    const bool meets_car =
        distance < kMinDistanceToCar && distance < (walker.at(walker.along) - car).norm();
    if (meets_car || next < 0.0 || next > walker.length) {
      walker.speed = -walker.speed;
    } else {
      walker.along = next;
    }
    Obstacle disc;
    disc.radius = walker.radius;
    const Eigen::Vector2d place = walker.at(walker.along);
    disc.in_map = {place.x(), place.y(), 0.0};
    crowd.push_back(disc);
  }
  return crowd;
}

Opponent::Opponent(std::uint64_t seed) : phase_(Random(seed).uniform(-kPi, kPi)) {}

Obstacle Opponent::follow(const Pose2& base_in_map, double time, const World& world) {
  const CarParameters car;
  const double desired = kSwayAmplitude * std::sin(2.0 * kPi * time / kSwayPeriod + phase_);
  // The free position nearest to the desired one, which is used if there is none.
  double target = desired;
  double off = HUGE_VAL;
  for (double angle = -kMaxAngle; angle <= kMaxAngle; angle += 0.05) {
    if (std::abs(angle - desired) >= off) continue;
    if (touches(opponentAt(base_in_map, angle), car, world, {}, time)) continue;
    off = std::abs(angle - desired);
    target = angle;
  }
  const double reach = last_time_ ? kAngularSpeed * (time - *last_time_) : HUGE_VAL;
  angle_ += std::clamp(target - angle_, -reach, reach);
  last_time_ = time;

  Obstacle opponent;
  opponent.shape = Obstacle::Shape::kBox;
  opponent.length = car.length_ahead + car.length_behind;
  opponent.width = car.width;
  opponent.in_map = compose(opponentAt(base_in_map, angle_), kCentreInBase);
  opponent.keeps_clear = true;
  return opponent;
}

}  // namespace racecar_mcl::sim
