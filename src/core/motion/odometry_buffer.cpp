#include "racecar_mcl/motion/odometry_buffer.h"

#include <algorithm>
#include <cmath>

#include "motion/stamped_entries.h"
#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

constexpr double kBufferDuration = 10.0;  // s
// Over a longer gap nothing is integrated: the clock was set forward, or the motion is unknown.
constexpr double kLongestGap = 20.0;   // s
constexpr double kRestDuration = 0.5;  // s, a car stands still before it counts as at rest
// Below these speeds the car counts as stationary.
constexpr double kStationarySpeed = 1e-3;     // m/s
constexpr double kStationaryTurnRate = 1e-3;  // rad/s
// Plausibility limits. Poses may jitter by the tolerance between two messages.
constexpr double kMaxSpeed = 100.0;     // m/s
constexpr double kMaxTurnRate = 100.0;  // rad/s
constexpr double kPoseTolerance = 0.5;  // m and rad
// Half angle below which the quotient half / tan(half) is replaced by its Taylor series.
constexpr double kSmallAngle = 1e-4;  // rad

OdometryState advance(const OdometryState& from, const Twist2& twist, double seconds,
                      double messages) {
  const double speed = std::hypot(twist.vx, twist.vy);
  const bool moving = speed > kStationarySpeed || std::abs(twist.wz) > kStationaryTurnRate;
  return {compose(from.base_in_odom, integrate(twist, seconds)),
          from.distance + speed * seconds,
          from.rotation + std::abs(twist.wz) * seconds,
          from.seconds + (moving ? seconds : 0.0),
          from.messages + messages,
          twist,
          from.turn + twist.wz * seconds};
}

/// The constant twist that moves a body by `delta` in `seconds`: the inverse of `integrate`.
Twist2 twistOf(const Pose2& delta, double seconds) {
  const double half = delta.yaw / 2.0;
  const double a = std::abs(half) < kSmallAngle ? 1.0 - half * half / 3.0 : half / std::tan(half);
  return {(a * delta.x + half * delta.y) / seconds, (a * delta.y - half * delta.x) / seconds,
          delta.yaw / seconds};
}

bool isPlausible(const Twist2& twist) {
  return std::hypot(twist.vx, twist.vy) <= kMaxSpeed && std::abs(twist.wz) <= kMaxTurnRate;
}

/// Whether a motion is within the plausibility limits; false if it is not finite.
bool isPlausible(const Pose2& delta, double seconds) {
  return std::hypot(delta.x, delta.y) <= kMaxSpeed * seconds + kPoseTolerance &&
         std::abs(delta.yaw) <= kMaxTurnRate * seconds + kPoseTolerance;
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
          later.turn - earlier.turn};
}

OdometryBuffer::OdometryBuffer(const OdometryParameters& parameters)
    : parameters_((validate(parameters), parameters)), clock_jump_(parameters.clock_jump) {}

void OdometryBuffer::setParameters(const OdometryParameters& parameters) {
  validate(parameters);
  parameters_ = parameters;
}

OdometryOutcome OdometryBuffer::add(const OdometrySample& sample) {
  const bool from_pose = parameters_.motion_from != MotionFrom::kTwist;
  if (!isWithin(sample.stamp, kMaxStamp) ||
      !(from_pose ? isWithin(sample.base_in_odom, kMaxCoordinate) : isFinite(sample.twist))) {
    return OdometryOutcome::kNotFinite;
  }
  if (!from_pose && !isPlausible(sample.twist)) return OdometryOutcome::kImplausible;
  const double max_stamp =
      entries_.empty() ? sample.stamp : entries_.back().stamp + parameters_.max_odometry_gap;
  const StampCheck check = clock_jump_.check(sample.stamp, max_stamp);
  if (check == StampCheck::kOutlier) {
    held_ = sample;
    return OdometryOutcome::kStampOutlier;
  }
  if (check == StampCheck::kClockJump && held_) {
    // The stamp before was right.
    const OdometrySample before = *held_;
    const OdometryOutcome outcome = insert(before);
    clock_jump_.check(sample.stamp, sample.stamp);
    insert(sample);
    return outcome;
  }
  return insert(sample);
}

OdometryOutcome OdometryBuffer::insert(const OdometrySample& sample) {
  held_.reset();
  const bool from_pose = parameters_.motion_from != MotionFrom::kTwist;
  // A first pose gives no velocity.
  const Twist2 first_twist = from_pose ? Twist2{} : sample.twist;
  if (entries_.empty()) {
    entries_.push_back({sample.stamp, {}, 0.0, first_twist, sample.base_in_odom, start_});
    return OdometryOutcome::kUsed;
  }

  const Entry& last = entries_.back();
  const double elapsed = sample.stamp - last.stamp;
  if (elapsed <= -clock_jump_.maxBack()) {
    reset();
    clock_jump_.check(sample.stamp, sample.stamp);
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
      // The odometry frame was reset: later motions are relative to this pose.
      outcome = OdometryOutcome::kImplausible;
    }
  } else {
    // Over a gap the twist is integrated for max_odometry_gap, spread over the whole gap.
    double ratio = outcome == OdometryOutcome::kGap ? parameters_.max_odometry_gap / elapsed : 1.0;
    if (elapsed > kLongestGap) ratio = 0.0;
    entry.twist = {sample.twist.vx * ratio, sample.twist.vy * ratio, sample.twist.wz * ratio};
  }
  entry.state = advance(last.state, entry.twist, elapsed, 1.0);
  entries_.push_back(entry);
  while (entries_.size() > 2 && entries_[1].stamp < sample.stamp - kBufferDuration) {
    entries_.pop_front();
  }
  return outcome;
}

void OdometryBuffer::reset() {
  clock_jump_.reset();
  held_.reset();
  if (entries_.empty()) return;
  start_ = entries_.back().state;
  entries_.clear();
}

OdometryState OdometryBuffer::at(double stamp) const {
  if (entries_.empty()) return start_;
  const Entry& newest = entries_.back();
  if (!(stamp < newest.stamp)) {
    const double past = stamp - newest.stamp;
    const double ahead = past > 0.0 ? std::min(past, parameters_.max_odometry_extrapolation) : 0.0;
    const double period = newest.seconds > 0.0 ? newest.seconds : ahead;
    return advance(newest.state, newest.twist_after, ahead, period > 0.0 ? ahead / period : 0.0);
  }
  const auto later = firstAfter(entries_, stamp);
  if (later == entries_.begin()) return entries_.front().state;
  const Entry& earlier = *(later - 1);
  const double elapsed = stamp - earlier.stamp;
  return advance(earlier.state, later->twist, elapsed, elapsed / later->seconds);
}

bool OdometryBuffer::isAtRest(double stamp) const {
  if (entries_.empty() || std::abs(stamp - newestStamp()) > kRestDuration) return false;
  const double begin = newestStamp() - kRestDuration;
  return entries_.front().stamp <= begin && at(begin).seconds == entries_.back().state.seconds;
}

OdometryBuffer OdometryBuffer::since(double stamp) const {
  OdometryBuffer part(parameters_);
  part.start_ = start_;
  part.entries_ = entriesSince(entries_, stamp);
  return part;
}

}  // namespace racecar_mcl
