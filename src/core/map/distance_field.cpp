#include "racecar_mcl/map/distance_field.h"

#include <cmath>
#include <limits>

#include "map/distance_transform.h"

namespace racecar_mcl {

std::vector<float> clearances(const std::vector<std::uint8_t>& mask, int width, int height) {
  return obstacleDistances(dilated(mask, width, height, 1), width, height);
}

std::vector<float> obstacleDistances(const std::vector<std::uint8_t>& mask, int width, int height) {
  std::vector<float> distances(mask.size());
  DistanceTransform(mask, width, height).forEachRow([&](int row, const std::uint32_t* squared) {
    float* const cells = distances.data() + static_cast<std::ptrdiff_t>(row) * width;
    for (int column = 0; column < width; ++column) {
      cells[column] = squared[column] == DistanceTransform::kFar
                          ? std::numeric_limits<float>::infinity()
                          : std::sqrt(static_cast<float>(squared[column]));
    }
  });
  return distances;
}

}  // namespace racecar_mcl
