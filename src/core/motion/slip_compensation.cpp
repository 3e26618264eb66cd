#include "racecar_mcl/motion/slip_compensation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/scalars.h"

namespace racecar_mcl {
namespace {

// The speed of a car cannot change faster than the grip of its tyres allows.
constexpr double kMaxAcceleration = 15.0;  // m/s^2
// A difference between the speeds of the odometry and of the car up to the larger of the first two,
// plus the third, is not compensated: the motion noise and the calibration of the odometry cover
// it.
constexpr double kMinDifference = 0.3;       // m/s
constexpr double kMinDistance = 0.0075;      // m, between two scans
constexpr double kMinDifferenceRatio = 0.1;  // of the larger speed
// A change that starts the compensation exceeds the noise of the odometry, which is the mean
// difference of two changes that follow each other, by this factor.
constexpr double kMinChangeRatio = 3.0;
constexpr double kNoiseTimeConstant = 0.5;  // s
constexpr double kInitialNoise = 0.3;       // m/s
// A motion continues at the estimated speed for this time, then stops. Estimates further apart say
// nothing about the speed.
constexpr double kMaxTime = 0.5;  // s
// Standard deviation of the acceleration of a turn.
constexpr double kTurnAcceleration = 30.0;  // rad/s^2
// Time constants of the averages, and the least time between two updates: the estimates of lidars
// that scan shortly after each other differ by their systematic errors.
constexpr double kSpeedTimeConstant = 0.1;  // s
constexpr double kTurnTimeConstant = 0.05;  // s
constexpr double kMinUpdateTime = 0.02;     // s

double gainAfter(double seconds, double time_constant) {
  return 1.0 - std::exp(-seconds / time_constant);
}

}  // namespace

SlipCompensation::Path SlipCompensation::pathWith(const Motion& odometry) const {
  Path path = path_;
  path.seconds += odometry.duration;
  path.odometry += odometry.delta.x;
  return path;
}

double SlipCompensation::expectedSpeed(const Path& path) const {
  const double limit = kMaxAcceleration * path.seconds;
  const double change = path.odometry / path.seconds - state_->odometry_speed;
  return state_->speed + bounded(change, limit);
}

std::optional<double> SlipCompensation::replacedSpeed(const Motion& odometry) const {
  if (!state_ || !(odometry.duration > 0.0)) return std::nullopt;
  const Path path = pathWith(odometry);
  const double odometry_speed = path.odometry / path.seconds;
  const double speed = expectedSpeed(path);
  const double larger_speed = std::max(std::abs(odometry_speed), std::abs(speed));
  const double tolerance =
      std::max(kMinDifference, kMinDistance / path.seconds) + kMinDifferenceRatio * larger_speed;
  const double change = std::abs(odometry_speed - state_->odometry_speed);
  if (!is_active_ && change <= kMinChangeRatio * state_->noise) return std::nullopt;
  if (std::abs(odometry_speed - speed) <= tolerance) return std::nullopt;
  return speed;
}

std::optional<Twist2> SlipCompensation::twist() const {
  if (!is_active_ || !state_) return std::nullopt;
  return Twist2{state_->speed, 0.0, state_->turn_rate};
}

Motion SlipCompensation::correct(const Motion& odometry,
                                 const MotionModelParameters& parameters) const {
  Motion motion = odometry;
  if (odometry.duration == 0.0) motion.compensation = twist();
  const std::optional<double> speed = replacedSpeed(odometry);
  if (!speed) return motion;
  const double seconds = std::min(odometry.duration, kMaxTime);
  const double turn_rate =
      odometry.turned_by_gyro ? odometry.delta.yaw / seconds : state_->turn_rate;
  motion.compensation = Twist2{*speed, 0.0, turn_rate};
  motion.delta = integrate(*motion.compensation, seconds);
  motion.distance = std::abs(*speed) * seconds;
  motion.rotation = std::abs(turn_rate) * seconds;
  motion.seconds = seconds;
  Eigen::Matrix3d covariance = motionCovariance(parameters, motion);
  covariance(0, 0) += square(odometry.delta.x - motion.delta.x);
  covariance(2, 2) +=
      square(odometry.delta.yaw - motion.delta.yaw) + square(kTurnAcceleration * seconds * seconds);
  motion.covariance = covariance;
  return motion;
}

void SlipCompensation::learn(const Motion& odometry, const Pose2& moved) {
  if (!(odometry.duration >= 0.0)) {  // the clock was set back
    reset();
    return;
  }
  if (odometry.duration > 0.0) is_active_ = replacedSpeed(odometry).has_value();
  path_ = pathWith(odometry);
  path_.moved += moved.x;
  path_.turned += moved.yaw;
  if (path_.seconds < kMinUpdateTime) return;
  if (path_.seconds > kMaxTime) {
    reset();
    return;
  }
  const Path path = std::exchange(path_, {});
  const double odometry_speed = path.odometry / path.seconds;
  const double turn_rate = path.turned / path.seconds;
  if (!state_) state_ = State{odometry_speed, turn_rate, odometry_speed, 0.0, kInitialNoise};
  state_->speed = correctedSpeed(path, is_active_ ? path.moved / path.seconds : odometry_speed);
  const double change = odometry_speed - state_->odometry_speed;
  if (!is_active_) {
    state_->noise += gainAfter(path.seconds, kNoiseTimeConstant) *
                     (std::abs(change - state_->change) - state_->noise);
  }
  state_->change = change;
  state_->turn_rate += gainAfter(path.seconds, kTurnTimeConstant) * (turn_rate - state_->turn_rate);
  state_->odometry_speed = odometry_speed;
}

double SlipCompensation::correctedSpeed(const Path& path, double measured) const {
  const double limit = kMaxAcceleration * path.seconds;
  const double expected = expectedSpeed(path);
  const double correction = gainAfter(path.seconds, kSpeedTimeConstant) * (measured - expected);
  return expected + bounded(correction, limit);
}

}  // namespace racecar_mcl
