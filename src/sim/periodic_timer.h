// Evenly spaced times, computed from a counter so that rounding errors do not accumulate.
#pragma once

namespace racecar_mcl::sim {

class PeriodicTimer {
 public:
  PeriodicTimer(double rate, double start) : rate_(rate), start_(start) {}

  /// The next due time, s.
  double next() const { return start_ + static_cast<double>(count_) / rate_; }

  void advance() { ++count_; }

  /// Changes the rate (Hz) from the next due time on.
  void setRate(double rate) {
    if (rate == rate_) return;
    start_ = next();
    count_ = 0;
    rate_ = rate;
  }

 private:
  double rate_;
  double start_;
  long count_ = 0;
};

}  // namespace racecar_mcl::sim
