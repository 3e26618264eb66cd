// Times at which something is due, evenly spaced: counted, so that no rounding adds up.
#pragma once

namespace racecar_mcl::sim {

class Metronome {
 public:
  Metronome(double rate, double start) : rate_(rate), start_(start) {}

  /// s, the next time due.
  double next() const { return start_ + static_cast<double>(count_) / rate_; }

  void advance() { ++count_; }

  /// From the next time due on, `rate` (Hz).
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
