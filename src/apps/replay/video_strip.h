// A strip under the film: a value over the last seconds.
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <string>

namespace racecar_mcl {

/// Draws values over the last `seconds` up to now; the newest is at the right.
class ValueStrip {
 public:
  /// `least_top`: the scale never ends below this. `fixed_top`: it never changes.
  ValueStrip(std::string title, std::string unit, const cv::Scalar& colour, double seconds,
             double least_top, bool fixed_top);

  void add(double time, double value);
  void draw(double now, cv::Mat picture) const;

 private:
  struct Sample {
    double time;
    double value;
  };
  double top() const;

  std::string title_;
  std::string unit_;
  cv::Scalar colour_;
  double seconds_;
  double least_top_;
  bool fixed_top_;
  std::deque<Sample> samples_;
};

}  // namespace racecar_mcl
