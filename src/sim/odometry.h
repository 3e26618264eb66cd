// Wheel odometry with noise, scale errors, biases, wheel slip and dropouts.
#pragma once

#include <deque>
#include <optional>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/motion/odometry_buffer.h"
#include "sim/car.h"
#include "sim/periodic_timer.h"

namespace racecar_mcl::sim {

struct OdometryParameters {
  double rate = 50.0;           ///< Hz
  Twist2 noise{0.1, 0.1, 0.1};  ///< standard deviation of each twist component (m/s, m/s, rad/s)
  double speed_scale_error = 0.02;     ///< reported speed = (1 + error) true speed
  double rotation_scale_error = 0.03;  ///< the same for the turn rate
  double speed_bias = 0.0;             ///< m/s, added to the speed
  double turn_bias = 0.0;              ///< rad/s, added to the turn rate
  /// During a burst the wheels turn (1 + slip) or (1 - slip) times as fast as the car moves, with
  /// equal probability. The turn rate is computed from the wheel speed, so it has the same error.
  double slip = 0.0;
  double slip_rate = 0.5;      ///< bursts per second outside bursts
  double slip_duration = 0.4;  ///< s, mean; uniform from 0.5 to 1.5 times this
  double dropout_rate = 0.0;   ///< fraction of lost messages
  double turn_delay = 0.0;     ///< s; a message has the turn rate of this time before its stamp
  /// The turn rate is computed from the commanded steering angle, as the VESC's odometry does, and
  /// so leads the car's.
  bool turn_from_command = false;

  /// Throws ParameterError, naming the field.
  void validate() const;
};

class WheelOdometry {
 public:
  WheelOdometry(const OdometryParameters& parameters, std::uint64_t seed, double start);

  /// Takes effect with the next message.
  void setParameters(const OdometryParameters& parameters) { parameters_ = parameters; }

  /// The message in [arc.begin, arc.end), if there is one and it is not lost. The pose also
  /// integrates lost messages, which are lost in transmission. `commanded_turn_rate`: rad/s, that
  /// of the commanded steering angle.
  std::optional<OdometrySample> measure(const Arc& arc, double commanded_turn_rate);

 private:
  /// A turn rate at a time.
  struct TurnRate {
    double begin = 0.0;  ///< s
    double value = 0.0;  ///< rad/s
  };

  double nextSlipFactor(double time);

  OdometryParameters parameters_;
  Random random_;
  Random slip_random_;
  PeriodicTimer messages_;
  std::optional<OdometrySample> last_;
  std::deque<TurnRate> turn_rates_;  ///< of the last turn_delay seconds
  double slip_until_ = 0.0;          ///< s
  double slip_sign_ = 1.0;
};

}  // namespace racecar_mcl::sim
