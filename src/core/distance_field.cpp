#include "racecar_mcl/distance_field.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace racecar_mcl {

std::vector<float> clearances(const std::vector<std::uint8_t>& mask, int width, int height) {
  if (width <= 0 || height <= 0 ||
      mask.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw std::invalid_argument("a mask of " + std::to_string(mask.size()) +
                                " cells does not fit " + std::to_string(width) + " x " +
                                std::to_string(height));
  }
  std::vector<float> result(mask.size(), std::numeric_limits<float>::infinity());
  if (std::find(mask.begin(), mask.end(), 1) == mask.end()) return result;

  cv::Mat obstacles(height, width, CV_8U);
  std::transform(mask.begin(), mask.end(), obstacles.begin<std::uint8_t>(),
                 [](std::uint8_t value) { return value != 0 ? 255 : 0; });
  cv::Mat grown;
  cv::dilate(obstacles, grown, cv::Mat::ones(3, 3, CV_8U));
  cv::Mat distances(height, width, CV_32F, result.data());
  cv::distanceTransform(255 - grown, distances, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  return result;
}

}  // namespace racecar_mcl
