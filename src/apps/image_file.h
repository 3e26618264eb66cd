// Pictures of maps: files and legends.
#pragma once

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace racecar_mcl {

/// Throws std::runtime_error if the image cannot be written.
inline void writeImage(const cv::Mat& picture, const std::string& path) {
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {  // unknown extension
  }
  if (!written) {
    throw std::runtime_error(path +
                             ": cannot write the image; expected a name such as map.png in an "
                             "existing folder");
  }
}

/// Colours (BGR) and their names, scaled with the width of the picture (pixels).
inline cv::Mat drawLegend(const std::vector<std::pair<cv::Vec3b, std::string>>& entries,
                          int width) {
  const double unit = std::max(1.0, width / 1600.0);
  const auto pixels = [&](double count) { return cvRound(count * unit); };
  const int needed = pixels(12.0 + 112.0 * static_cast<double>(entries.size()));
  cv::Mat legend(pixels(30), std::max(width, needed), CV_8UC3, cv::Scalar::all(255));
  cv::line(legend, {0, 0}, {legend.cols, 0}, cv::Scalar::all(150));
  int x = pixels(10);
  for (const auto& [colour, name] : entries) {
    const cv::Rect box(x, pixels(9), pixels(14), pixels(14));
    cv::rectangle(legend, box, cv::Scalar(colour), cv::FILLED);
    cv::rectangle(legend, box, cv::Scalar::all(90), 1);
    cv::putText(legend, name, {x + pixels(21), pixels(21)}, cv::FONT_HERSHEY_SIMPLEX, 0.5 * unit,
                cv::Scalar(48, 36, 28), pixels(1), cv::LINE_AA);
    x += pixels(112);
  }
  return legend;
}

/// The picture with a legend below.
inline cv::Mat withLegend(const cv::Mat& picture, const cv::Mat& legend) {
  cv::Mat whole(picture.rows + legend.rows, std::max(picture.cols, legend.cols), CV_8UC3,
                cv::Scalar::all(255));
  picture.copyTo(whole(cv::Rect(0, 0, picture.cols, picture.rows)));
  legend.copyTo(whole(cv::Rect(0, picture.rows, legend.cols, legend.rows)));
  return whole;
}

/// The whole number by which small pictures are magnified.
inline int magnificationOf(const cv::Size& cells) {
  constexpr int kMinImageSize = 1200;    // pixels
  constexpr int kMaxPixelsPerCell = 40;  // pixels
  return std::clamp(cvRound(1.0 * kMinImageSize / std::max(cells.width, cells.height)), 1,
                    kMaxPixelsPerCell);
}

}  // namespace racecar_mcl
