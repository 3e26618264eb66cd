#include "sim/driver.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl::sim {
namespace {

constexpr double kPatience = 1.0;         // s, stood against something
constexpr double kBetweenContacts = 0.5;  // s, that are one
constexpr double kBackOff = 1.0;          // s
constexpr double kTurnAway = 0.7;         // s
constexpr double kStart = 0.3;            // s, after which a car that can move moves
constexpr double kStanding = 0.05;        // m/s, and slower
constexpr double kSight = 4.0;            // m, room farther away does not count
constexpr double kSoon = 10.0;            // s, between tries that belong together
constexpr int kTriesToOneSide = 4;

/// The side with more room ahead of the car's axle: 1 left, -1 right.
double roomierSide(const LidarScan& sweep) {
  double left_minus_right = 0.0;
  for (std::size_t i = 0; i < sweep.ranges.size(); ++i) {
    const double bearing = sweep.angle_min + static_cast<double>(i) * sweep.angle_increment;
    if (std::abs(bearing) > kPi / 2.0) continue;
    const double room = std::min(static_cast<double>(sweep.ranges[i]), kSight);
    left_minus_right += std::copysign(std::max(room, 0.0), bearing);
  }
  return left_minus_right >= 0.0 ? 1.0 : -1.0;
}

}  // namespace

void Driver::begin(Phase phase, double stamp) {
  phase_ = phase;
  since_ = stamp;
}

void Driver::choosePhase(const LidarScan& sweep, double speed, bool collided) {
  const double now = sweep.stamp;
  if (phase_ == Phase::kFollow) {
    // To and fro before a wall is standing against it.
    if (!collided) return;
    if (now - last_contact_ > kBetweenContacts) since_ = now;
    last_contact_ = now;
    if (now - since_ <= kPatience) return;
    tries_ = now - last_try_ < kSoon ? tries_ + 1 : 0;
    last_try_ = now;
    // A turn on the spot takes several tries to one side; where they do not help, the other may.
    if (tries_ == 0) turn_ = roomierSide(sweep);
    if (tries_ > 0 && tries_ % kTriesToOneSide == 0) turn_ = -turn_;
    begin(Phase::kBackOff, now);
    return;
  }
  const bool stands = now - since_ > kStart && std::abs(speed) < kStanding;
  const double longest = phase_ == Phase::kBackOff ? kBackOff : kTurnAway;
  if (!stands && now - since_ <= longest) return;
  begin(phase_ == Phase::kBackOff ? Phase::kTurnAway : Phase::kFollow, now);
}

Command Driver::drive(const LidarScan& sweep, double speed, bool collided) {
  choosePhase(sweep, speed, collided);
  const WallFollowerParameters& p = follower_.parameters();
  const double slowly = std::min(p.min_speed, p.speed);
  // Wheels turned to the left swing the nose to the right while the car goes back.
  if (phase_ == Phase::kBackOff) return {-slowly, -turn_ * p.car.max_steering};
  if (phase_ == Phase::kTurnAway) return {slowly, turn_ * p.car.max_steering};
  return follower_.follow(sweep, speed);
}

}  // namespace racecar_mcl::sim
