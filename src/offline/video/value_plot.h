// Plot of a value over the last seconds, below the map view.
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <string>

namespace racecar_mcl::video {

/// Draws values over the last `seconds`; the newest is at the right.
class ValuePlot {
 public:
  /// `min_top`: minimum upper limit of the scale; with `fixed_top` the limit is constant.
  ValuePlot(std::string title, std::string unit, const cv::Scalar& colour, double seconds,
            double min_top, bool fixed_top);

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
  double min_top_;
  bool fixed_top_;
  std::deque<Sample> samples_;
};

}  // namespace racecar_mcl::video
