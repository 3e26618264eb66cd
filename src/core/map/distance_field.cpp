#include "racecar_mcl/map/distance_field.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace racecar_mcl {

namespace {

cv::Mat obstacleImage(const std::vector<std::uint8_t>& mask, int width, int height) {
  if (width <= 0 || height <= 0 ||
      mask.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw std::invalid_argument("a mask of " + std::to_string(mask.size()) +
                                " cells does not fit " + std::to_string(width) + " x " +
                                std::to_string(height));
  }
  cv::Mat obstacles(height, width, CV_8U);
  std::transform(mask.begin(), mask.end(), obstacles.begin<std::uint8_t>(),
                 [](std::uint8_t value) { return value != 0 ? 255 : 0; });
  return obstacles;
}

std::vector<float> distancesTo(const cv::Mat& obstacles) {
  std::vector<float> result(obstacles.total(), std::numeric_limits<float>::infinity());
  if (cv::countNonZero(obstacles) == 0) return result;
  cv::Mat distances(obstacles.rows, obstacles.cols, CV_32F, result.data());
  cv::distanceTransform(255 - obstacles, distances, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  return result;
}

}  // namespace

std::vector<float> clearances(const std::vector<std::uint8_t>& mask, int width, int height) {
  cv::Mat dilated;
  cv::dilate(obstacleImage(mask, width, height), dilated, cv::Mat::ones(3, 3, CV_8U));
  return distancesTo(dilated);
}

std::vector<float> obstacleDistances(const std::vector<std::uint8_t>& mask, int width, int height) {
  return distancesTo(obstacleImage(mask, width, height));
}

}  // namespace racecar_mcl
