#include "sim/driver.h"

#include <algorithm>
#include <cmath>

namespace racecar_mcl::sim {
namespace {

constexpr double kStuckTime = 1.0;      // s of contact
constexpr double kContactGap = 0.5;     // s; contacts closer in time are one
constexpr double kBackOff = 1.0;        // s
constexpr double kTurnAway = 0.7;       // s
constexpr double kStartTime = 0.3;      // s for the car to start moving
constexpr double kStoppedSpeed = 0.05;  // m/s
constexpr double kFarRoom = 4.0;        // m
constexpr double kRetryWindow = 10.0;   // s between consecutive attempts
constexpr int kAttemptsPerSide = 4;

/// The side with more free space ahead: 1 left, -1 right.
double sideWithMoreRoom(const LidarScan& sweep) {
  double left_minus_right = 0.0;
  for (std::size_t i = 0; i < sweep.ranges.size(); ++i) {
    const double bearing = sweep.angle_min + static_cast<double>(i) * sweep.angle_increment;
    if (std::abs(bearing) > kPi / 2.0) continue;
    const double room = std::min(static_cast<double>(sweep.ranges[i]), kFarRoom);
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
    // Short contacts in quick succession count as one.
    if (!collided) return;
    if (now - last_contact_ > kContactGap) since_ = now;
    last_contact_ = now;
    if (now - since_ <= kStuckTime) return;
    attempts_ = now - last_attempt_ < kRetryWindow ? attempts_ + 1 : 0;
    last_attempt_ = now;
    // A turn in place takes several attempts to one side; then the other side is tried.
    if (attempts_ == 0) turn_ = sideWithMoreRoom(sweep);
    if (attempts_ > 0 && attempts_ % kAttemptsPerSide == 0) turn_ = -turn_;
    begin(Phase::kBackOff, now);
    return;
  }
  const bool is_stopped = now - since_ > kStartTime && std::abs(speed) < kStoppedSpeed;
  const double max_duration = phase_ == Phase::kBackOff ? kBackOff : kTurnAway;
  if (!is_stopped && now - since_ <= max_duration) return;
  begin(phase_ == Phase::kBackOff ? Phase::kTurnAway : Phase::kFollow, now);
}

Command Driver::drive(const LidarScan& sweep, double speed, bool collided) {
  choosePhase(sweep, speed, collided);
  const WallFollowerParameters& p = follower_.parameters();
  const double slow_speed = std::min(p.min_speed, p.speed);
  // In reverse, left steering turns the car to the right.
  if (phase_ == Phase::kBackOff) return {-slow_speed, -turn_ * p.car.max_steering};
  if (phase_ == Phase::kTurnAway) return {slow_speed, turn_ * p.car.max_steering};
  return follower_.follow(sweep, speed);
}

}  // namespace racecar_mcl::sim
