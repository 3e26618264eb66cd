#include "offline/video/value_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "offline/video/map_view.h"

namespace racecar_mcl::video {
namespace {

constexpr int kLeft = 240, kRight = 16, kTop = 10, kBottom = 10;  // margins, pixels

/// The smallest 1, 2 or 5 times a power of ten that is at least `value`.
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

ValuePlot::ValuePlot(std::string title, std::string unit, const cv::Scalar& colour, double seconds,
                     double min_top, bool fixed_top)
    : title_(std::move(title)),
      unit_(std::move(unit)),
      colour_(colour),
      seconds_(seconds),
      min_top_(min_top),
      fixed_top_(fixed_top) {}

void ValuePlot::add(double time, double value) {
  samples_.push_back({time, value});
  // Keeps one sample before the window, so that the line starts at its edge.
  while (samples_.size() > 2 && samples_[1].time < time - seconds_) samples_.pop_front();
}

double ValuePlot::top() const {
  if (fixed_top_) return min_top_;
  double largest = min_top_;
  for (const Sample& sample : samples_) largest = std::max(largest, sample.value);
  return roundUp(largest);
}

void ValuePlot::draw(double now, cv::Mat picture) const {
  picture.setTo(palette::kBackground);
  const cv::Rect plot(kLeft, kTop, picture.cols - kLeft - kRight, picture.rows - kTop - kBottom);
  const double highest = top();
  cv::rectangle(picture, plot, cv::Scalar(225, 220, 215));
  drawText(picture, title_, {16, picture.rows / 2 - 6}, palette::kText);
  drawText(picture, text(highest), {plot.x - 48, plot.y + 14}, palette::kGrey, 0.45);
  drawText(picture, "0", {plot.x - 18, plot.y + plot.height}, palette::kGrey, 0.45);
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

}  // namespace racecar_mcl::video
