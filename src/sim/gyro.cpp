#include "sim/gyro.h"

#include <cmath>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl::sim {

void GyroParameters::validate() const {
  requirePositiveUpTo("gyro rate", rate, 1000.0, "Hz");
  requireNotNegative("gyro noise", noise, "rad/s");
  requireFinite("gyro bias", bias, "rad/s");
  require(std::isfinite(scale_error) && scale_error > -1.0, "gyro scale_error", scale_error,
          "above -1 and finite");
  requireWithin("gyro delay", delay, 0.0, 1.0);
}

Gyro::Gyro(const GyroParameters& parameters, std::uint64_t seed, double start)
    : parameters_(parameters), random_(seed), samples_(parameters.rate, start) {}

std::optional<GyroSample> Gyro::measure(const Arc& arc) {
  past_.push_back(arc);
  while (past_.size() > 1 && past_[1].begin <= arc.begin - parameters_.delay) past_.pop_front();
  if (samples_.next() >= arc.end) return std::nullopt;
  GyroSample sample;
  sample.stamp = samples_.next();
  samples_.setRate(parameters_.rate);
  samples_.advance();
  sample.yaw_rate = (1.0 + parameters_.scale_error) * past_.front().twist.wz + parameters_.bias +
                    parameters_.noise * random_.gaussian();
  if (parameters_.in_degrees) sample.yaw_rate *= 180.0 / kPi;
  if (!parameters_.enabled) return std::nullopt;
  return sample;
}

}  // namespace racecar_mcl::sim
