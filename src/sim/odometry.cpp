#include "sim/odometry.h"

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {

void OdometryParameters::validate() const {
  requirePositiveUpTo("odometry rate", rate, 1000.0, "Hz");
  requireNotNegative("odometry noise vx", noise.vx, "m/s");
  requireNotNegative("odometry noise vy", noise.vy, "m/s");
  requireNotNegative("odometry noise wz", noise.wz, "rad/s");
  require(std::isfinite(speed_scale_error) && speed_scale_error > -1.0, "speed_scale_error",
          speed_scale_error, "above -1 and finite");
  require(std::isfinite(rotation_scale_error) && rotation_scale_error > -1.0,
          "rotation_scale_error", rotation_scale_error, "above -1 and finite");
  requireFinite("speed_bias", speed_bias, "m/s");
  requireFinite("turn_bias", turn_bias, "rad/s");
  requireShare("slip", slip);
  requireNotNegative("slip_rate", slip_rate, "1/s");
  requirePositive("slip_duration", slip_duration, "s");
  requireShare("odometry dropout_rate", dropout_rate);
  requireWithin("odometry turn_delay", turn_delay, 0.0, 1.0);
}

WheelOdometry::WheelOdometry(const OdometryParameters& parameters, std::uint64_t seed, double start)
    : parameters_(parameters),
      random_(seed),
      slip_random_(random_()),
      messages_(parameters.rate, start),
      slip_until_(start) {}

std::optional<OdometrySample> WheelOdometry::measure(const Arc& arc, double commanded_turn_rate) {
  turn_rates_.push_back(
      {arc.begin, parameters_.turn_from_command ? commanded_turn_rate : arc.twist.wz});
  while (turn_rates_.size() > 1 && turn_rates_[1].begin <= arc.begin - parameters_.turn_delay) {
    turn_rates_.pop_front();
  }
  if (messages_.next() >= arc.end) return std::nullopt;
  OdometrySample sample;
  sample.stamp = messages_.next();
  messages_.setRate(parameters_.rate);
  messages_.advance();

  const double slip = nextSlipFactor(sample.stamp);
  const OdometryParameters& p = parameters_;
  // All numbers are drawn for every message, so that parameters do not affect each other's noise.
  sample.twist.vx = slip * (1.0 + p.speed_scale_error) * arc.twist.vx + p.speed_bias +
                    p.noise.vx * random_.gaussian();
  sample.twist.vy = arc.twist.vy + p.noise.vy * random_.gaussian();
  sample.twist.wz = slip * (1.0 + p.rotation_scale_error) * turn_rates_.front().value +
                    p.turn_bias + p.noise.wz * random_.gaussian();
  const bool lost = random_.uniform() < p.dropout_rate;

  if (last_) {
    const Twist2 mean{(last_->twist.vx + sample.twist.vx) / 2.0,
                      (last_->twist.vy + sample.twist.vy) / 2.0,
                      (last_->twist.wz + sample.twist.wz) / 2.0};
    sample.base_in_odom =
        compose(last_->base_in_odom, integrate(mean, sample.stamp - last_->stamp));
  }
  last_ = sample;
  return lost ? std::nullopt : last_;
}

double WheelOdometry::nextSlipFactor(double time) {
  const double chance = slip_random_.uniform();
  const double duration = parameters_.slip_duration * slip_random_.uniform(0.5, 1.5);
  const double sign = slip_random_.uniform() < 0.5 ? -1.0 : 1.0;
  if (time >= slip_until_) {
    if (chance >= parameters_.slip_rate / parameters_.rate) return 1.0;
    slip_until_ = time + duration;
    slip_sign_ = sign;
  }
  return 1.0 + slip_sign_ * parameters_.slip;
}

}  // namespace racecar_mcl::sim
