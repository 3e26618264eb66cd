// Wheel odometry as a racecar has it: noisy, biased, fooled by slipping wheels, and at times not
// there.
#pragma once

#include <optional>

#include "racecar_mcl/odometry.h"
#include "racecar_mcl/random.h"
#include "sim/car.h"
#include "sim/metronome.h"

namespace racecar_mcl::sim {

struct OdometryParameters {
  double rate = 50.0;           ///< Hz
  Twist2 noise{0.1, 0.1, 0.1};  ///< standard deviation of each twist component (m/s, m/s, rad/s)
  double speed_scale_error = 0.02;  ///< speed is reported (1 + this) times too large
  double turn_scale_error = 0.03;   ///< so is the turn rate
  double speed_bias = 0.0;          ///< m/s, added to the speed
  double turn_bias = 0.0;           ///< rad/s, added to the turn rate
  /// In a burst the wheels turn (1 + slip) or (1 - slip) times as fast as the car moves; even odds.
  /// The turn rate is worked out from the wheel speed, as drivers of such cars do, so it goes wrong
  /// with it.
  double slip = 0.0;
  double slip_rate = 0.5;      ///< bursts per second, while none is under way
  double slip_duration = 0.4;  ///< s, mean; a burst lasts half to one and a half times as long
  double dropout_rate = 0.0;   ///< share of messages that never arrive

  /// Throws ParameterError, naming the field.
  void validate() const;
};

class WheelOdometry {
 public:
  WheelOdometry(const OdometryParameters& parameters, std::uint64_t seed, double start);

  /// Holds from the next message on.
  void setParameters(const OdometryParameters& parameters) { parameters_ = parameters; }

  /// The message due in [arc.begin, arc.end), if one is, and if it arrives. The pose is
  /// summed up from the lost ones too: they are lost on their way from the car's driver.
  std::optional<OdometrySample> measure(const Arc& arc);

 private:
  double nextSlipFactor(double time);

  OdometryParameters parameters_;
  Random random_;
  Random slip_random_;
  Metronome messages_;
  std::optional<OdometrySample> last_;
  double slip_until_ = 0.0;  ///< s
  double slip_sign_ = 1.0;
};

}  // namespace racecar_mcl::sim
