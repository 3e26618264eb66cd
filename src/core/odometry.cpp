#include "racecar_mcl/odometry.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

constexpr double kHistorySeconds = 10.0;
// Under these a car stands still, whatever its encoders whisper.
constexpr double kStillSpeed = 1e-3;  // m/s
constexpr double kStillTurn = 1e-3;   // rad/s
// Over these no car moves. A pose may still jitter by the slack between two messages.
constexpr double kFastest = 100.0;      // m/s
constexpr double kFastestTurn = 100.0;  // rad/s
constexpr double kSlack = 0.5;          // m and rad

OdometryState advance(const OdometryState& from, const Twist2& twist, double seconds,
                      double messages) {
  const double speed = std::hypot(twist.vx, twist.vy);
  const bool moving = speed > kStillSpeed || std::abs(twist.wz) > kStillTurn;
  return {compose(from.base_in_odom, integrate(twist, seconds)),
          from.distance + speed * seconds,
          from.rotation + std::abs(twist.wz) * seconds,
          from.seconds + (moving ? seconds : 0.0),
          from.messages + messages,
          twist};
}

/// The constant twist that moves a body by `delta` in `seconds`: the inverse of `integrate`.
Twist2 twistOf(const Pose2& delta, double seconds) {
  const double half = delta.yaw / 2.0;
  const double a = std::abs(half) < 1e-4 ? 1.0 - half * half / 3.0 : half / std::tan(half);
  return {(a * delta.x + half * delta.y) / seconds, (a * delta.y - half * delta.x) / seconds,
          delta.yaw / seconds};
}

bool isPlausible(const Twist2& twist) {
  return std::hypot(twist.vx, twist.vy) <= kFastest && std::abs(twist.wz) <= kFastestTurn;
}

/// Whether a car can have moved by `delta`; false where it is not finite.
bool isPlausible(const Pose2& delta, double seconds) {
  return std::hypot(delta.x, delta.y) <= kFastest * seconds + kSlack &&
         std::abs(delta.yaw) <= kFastestTurn * seconds + kSlack;
}

}  // namespace

void validate(const OdometryParameters& p) {
  requirePositive("max_odometry_gap", p.max_odometry_gap, "s");
  requireNotNegative("max_odometry_extrapolation", p.max_odometry_extrapolation, "s");
  requirePositive("clock_jump", p.clock_jump, "s");
}

Motion motionBetween(const OdometryState& earlier, const OdometryState& later) {
  return {between(earlier.base_in_odom, later.base_in_odom),
          std::max(0.0, later.distance - earlier.distance),
          std::max(0.0, later.rotation - earlier.rotation),
          std::max(0.0, later.seconds - earlier.seconds),
          std::max(0.0, later.messages - earlier.messages),
          {later.twist.vx - earlier.twist.vx, later.twist.vy - earlier.twist.vy,
           later.twist.wz - earlier.twist.wz},
          1.0,
          {}};
}

std::string describe(OdometryOutcome outcome) {
  switch (outcome) {
    case OdometryOutcome::kUsed:
      return "used";
    case OdometryOutcome::kNotFinite:
      return "odometry holds NaN or inf";
    case OdometryOutcome::kImplausible:
      return "odometry says that the car moved faster than any car can";
    case OdometryOutcome::kRepeatedStamp:
      return "odometry stamp repeats";
    case OdometryOutcome::kOutOfOrder:
      return "odometry is older than the newest";
    case OdometryOutcome::kGap:
      return "odometry was missing for longer than max_odometry_gap";
    case OdometryOutcome::kTimeJumpedBack:
      return "odometry time jumped back";
  }
  return "unknown";
}

OdometryHistory::OdometryHistory(const OdometryParameters& parameters)
    : parameters_((validate(parameters), parameters)) {}

OdometryOutcome OdometryHistory::add(const OdometrySample& sample) {
  const bool from_pose = parameters_.motion_from != MotionFrom::kTwist;
  if (!std::isfinite(sample.stamp) ||
      !(from_pose ? isFinite(sample.base_in_odom) : isFinite(sample.twist))) {
    return OdometryOutcome::kNotFinite;
  }
  if (!from_pose && !isPlausible(sample.twist)) return OdometryOutcome::kImplausible;
  // What a first message says of the motion that follows it: a pose says nothing.
  const Twist2 first_twist = from_pose ? Twist2{} : sample.twist;
  if (entries_.empty()) {
    entries_.push_back({sample.stamp, {}, 0.0, first_twist, sample.base_in_odom, start_});
    return OdometryOutcome::kUsed;
  }

  const Entry& last = entries_.back();
  const double elapsed = sample.stamp - last.stamp;
  if (elapsed <= -parameters_.clock_jump) {
    startAgain();
    entries_.push_back({sample.stamp, {}, 0.0, first_twist, sample.base_in_odom, start_});
    return OdometryOutcome::kTimeJumpedBack;
  }
  if (elapsed == 0.0) return OdometryOutcome::kRepeatedStamp;
  if (elapsed < 0.0) return OdometryOutcome::kOutOfOrder;

  OdometryOutcome outcome =
      elapsed > parameters_.max_odometry_gap ? OdometryOutcome::kGap : OdometryOutcome::kUsed;
  Entry entry{sample.stamp, {}, elapsed, sample.twist, sample.base_in_odom, {}};
  if (from_pose) {
    const Pose2 delta = between(last.base_in_odom, sample.base_in_odom);
    entry.twist_after = last.twist_after;
    if (isPlausible(delta, elapsed)) {
      entry.twist = twistOf(delta, elapsed);
      if (isPlausible(entry.twist)) entry.twist_after = entry.twist;
    } else {
      // The odometry frame was set anew: its poses count from here on.
      outcome = OdometryOutcome::kImplausible;
    }
  } else {
    // Over a gap the twist is believed for max_odometry_gap of it, spread over the whole.
    const double share =
        outcome == OdometryOutcome::kGap ? parameters_.max_odometry_gap / elapsed : 1.0;
    entry.twist = {sample.twist.vx * share, sample.twist.vy * share, sample.twist.wz * share};
  }
  entry.state = advance(last.state, entry.twist, elapsed, 1.0);
  entries_.push_back(entry);
  while (entries_.size() > 2 && entries_[1].stamp < sample.stamp - kHistorySeconds) {
    entries_.pop_front();
  }
  return outcome;
}

void OdometryHistory::startAgain() {
  if (entries_.empty()) return;
  start_ = entries_.back().state;
  entries_.clear();
}

OdometryState OdometryHistory::at(double stamp) const {
  if (entries_.empty()) return start_;
  const Entry& newest = entries_.back();
  if (!(stamp < newest.stamp)) {
    const double past = stamp - newest.stamp;
    const double ahead = past > 0.0 ? std::min(past, parameters_.max_odometry_extrapolation) : 0.0;
    const double period = newest.seconds > 0.0 ? newest.seconds : ahead;
    return advance(newest.state, newest.twist_after, ahead, period > 0.0 ? ahead / period : 0.0);
  }
  const auto later =
      std::upper_bound(entries_.begin(), entries_.end(), stamp,
                       [](double value, const Entry& entry) { return value < entry.stamp; });
  if (later == entries_.begin()) return entries_.front().state;
  const Entry& earlier = *(later - 1);
  const double elapsed = stamp - earlier.stamp;
  return advance(earlier.state, later->twist, elapsed, elapsed / later->seconds);
}

}  // namespace racecar_mcl
