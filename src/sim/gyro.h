// Gyro with noise, bias, scale error and delay.
#pragma once

#include <deque>
#include <optional>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/motion/gyro_buffer.h"
#include "sim/car.h"
#include "sim/periodic_timer.h"

namespace racecar_mcl::sim {

struct GyroParameters {
  bool enabled = false;
  double rate = 100.0;         ///< Hz
  double noise = 0.005;        ///< rad/s, standard deviation
  double bias = 0.01;          ///< rad/s
  double scale_error = 0.005;  ///< measured rate = (1 + error) true rate
  double delay = 0.0;          ///< s; a sample has the rate of this time before its stamp
  bool in_degrees = false;     ///< degrees per second, as the VESC's driver publishes them

  /// Throws ParameterError, naming the field.
  void validate() const;
};

class Gyro {
 public:
  Gyro(const GyroParameters& parameters, std::uint64_t seed, double start);

  /// Takes effect with the next sample.
  void setParameters(const GyroParameters& parameters) { parameters_ = parameters; }

  /// The sample in [arc.begin, arc.end), if there is one.
  std::optional<GyroSample> measure(const Arc& arc);

 private:
  GyroParameters parameters_;
  Random random_;
  PeriodicTimer samples_;
  std::deque<Arc> past_;  ///< the arcs of the last `delay` seconds
};

}  // namespace racecar_mcl::sim
