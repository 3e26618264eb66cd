#include "racecar_mcl/motion/gyro_buffer.h"

#include <algorithm>
#include <cmath>

#include "motion/stamped_entries.h"
#include "racecar_mcl/common/limits.h"

namespace racecar_mcl {
namespace {

constexpr double kGyroBufferDuration = 10.0;  // s
// A longer silence is a gap. IMUs of cars publish at 50 Hz or more.
constexpr double kMaxGap = 0.1;      // s
constexpr double kMaxRate = 5000.0;  // rad/s; MEMS gyros measure up to 2000 degrees per second
// Time constant of the bias at rest: the bias of MEMS gyros drifts over minutes.
constexpr double kBiasSeconds = 10.0;  // s
// Data sheets of MEMS gyros give a bias of at most 20 degrees per second. A higher rate is a
// motion.
constexpr double kMaxBias = 20.0;  // rad/s, or degrees per second

}  // namespace

const char* toString(GyroOutcome outcome) {
  switch (outcome) {
    case GyroOutcome::kUsed:
      return "used";
    case GyroOutcome::kNotFinite:
      return "the angular velocity or stamp of the IMU is NaN or inf";
    case GyroOutcome::kImplausible:
      return "the angular velocity of the IMU is above 5000 rad/s";
    case GyroOutcome::kOutOfOrder:
      return "the IMU's stamp is not newer than the newest";
    case GyroOutcome::kGap:
      return "the IMU was silent for longer than 0.1 s";
    case GyroOutcome::kTimeJumpedBack:
      return "the IMU's time jumped back";
  }
  return "unknown";
}

void GyroBuffer::learnBias(double rate, double seconds, bool at_rest) {
  if (!at_rest || std::abs(rate) > kMaxBias) return;
  rest_seconds_ = std::min(rest_seconds_ + seconds, kBiasSeconds);
  bias_ += (rate - bias_) * seconds / rest_seconds_;
}

GyroOutcome GyroBuffer::add(const GyroSample& sample, bool at_rest) {
  if (!isWithin(sample.stamp, kMaxStamp) || !std::isfinite(sample.yaw_rate)) {
    return GyroOutcome::kNotFinite;
  }
  if (std::abs(sample.yaw_rate) > kMaxRate) return GyroOutcome::kImplausible;
  GyroOutcome outcome = GyroOutcome::kUsed;
  if (!entries_.empty()) {
    const double elapsed = sample.stamp - entries_.back().stamp;
    if (elapsed <= -clock_jump_) {
      outcome = GyroOutcome::kTimeJumpedBack;
    } else if (elapsed <= 0.0) {
      return GyroOutcome::kOutOfOrder;
    } else if (elapsed > kMaxGap) {
      outcome = GyroOutcome::kGap;
    }
    if (outcome == GyroOutcome::kUsed) {
      learnBias(sample.yaw_rate, elapsed, at_rest);
      const GyroState& last = entries_.back().state;
      const double rate = sample.yaw_rate - bias_;
      entries_.push_back({sample.stamp, {last.turn + 0.5 * (last.rate + rate) * elapsed, rate}});
      while (entries_.front().stamp < sample.stamp - kGyroBufferDuration) entries_.pop_front();
      return outcome;
    }
    reset();
  }
  entries_.push_back({sample.stamp, {0.0, sample.yaw_rate - bias_}});
  return outcome;
}

std::optional<GyroState> GyroBuffer::at(double stamp) const {
  if (entries_.empty() || !(stamp >= entries_.front().stamp)) return std::nullopt;
  const Entry& newest = entries_.back();
  if (stamp >= newest.stamp) {
    const double past = stamp - newest.stamp;
    if (past > kMaxGap) return std::nullopt;
    return GyroState{newest.state.turn + newest.state.rate * past, newest.state.rate};
  }
  const auto later = firstAfter(entries_, stamp);
  const Entry& earlier = *(later - 1);
  const double elapsed = stamp - earlier.stamp;
  const double ratio = elapsed / (later->stamp - earlier.stamp);
  const double rate = earlier.state.rate + ratio * (later->state.rate - earlier.state.rate);
  return GyroState{earlier.state.turn + 0.5 * (earlier.state.rate + rate) * elapsed, rate};
}

GyroBuffer GyroBuffer::since(double stamp) const {
  GyroBuffer part(clock_jump_);
  part.entries_ = entriesSince(entries_, stamp);
  return part;
}

}  // namespace racecar_mcl
