#include "video_strip.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "video_view.h"

namespace racecar_mcl {
namespace {

constexpr int kLeft = 240, kRight = 16, kTop = 10, kBottom = 10;  // pixels about the plot

/// The next of 1, 2, 5, 10, 20, ... from `value` on, times a power of ten.
double roundUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power) return step * power;
  }
  return 10.0 * power;
}

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.3g", value);
  return buffer;
}

}  // namespace

ValueStrip::ValueStrip(std::string title, std::string unit, const cv::Scalar& colour,
                       double seconds, double least_top, bool fixed_top)
    : title_(std::move(title)),
      unit_(std::move(unit)),
      colour_(colour),
      seconds_(seconds),
      least_top_(least_top),
      fixed_top_(fixed_top) {}

void ValueStrip::add(double time, double value) {
  samples_.push_back({time, value});
  // One more than shown, so that the line comes in from outside.
  while (samples_.size() > 2 && samples_[1].time < time - seconds_) samples_.pop_front();
}

double ValueStrip::top() const {
  if (fixed_top_) return least_top_;
  double greatest = least_top_;
  for (const Sample& sample : samples_) greatest = std::max(greatest, sample.value);
  return roundUp(greatest);
}

void ValueStrip::draw(double now, cv::Mat picture) const {
  picture.setTo(film::kPaper);
  const cv::Rect plot(kLeft, kTop, picture.cols - kLeft - kRight, picture.rows - kTop - kBottom);
  const double highest = top();
  cv::rectangle(picture, plot, cv::Scalar(225, 220, 215));
  drawText(picture, title_, {16, picture.rows / 2 - 6}, film::kInk);
  drawText(picture, text(highest), {plot.x - 48, plot.y + 14}, film::kSoft, 0.45);
  drawText(picture, "0", {plot.x - 18, plot.y + plot.height}, film::kSoft, 0.45);
  if (samples_.empty()) return;

  drawText(picture, text(samples_.back().value) + " " + unit_, {16, picture.rows / 2 + 20}, colour_,
           0.65);
  std::vector<cv::Point> line;
  for (const Sample& sample : samples_) {
    const double right = (sample.time - now + seconds_) / seconds_;
    const double up = std::clamp(sample.value / highest, 0.0, 1.0);
    line.emplace_back(plot.x + cvRound(std::max(right, 0.0) * plot.width),
                      plot.y + plot.height - cvRound(up * plot.height));
  }
  cv::polylines(picture, line, false, colour_, 2, cv::LINE_AA);
}

}  // namespace racecar_mcl
