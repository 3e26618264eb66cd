#include "racecar_mcl/map/distance_field.h"

#include "map/distance_transform.h"

namespace racecar_mcl {

std::vector<float> clearances(const std::vector<std::uint8_t>& mask, int width, int height) {
  return obstacleDistances(dilated(mask, width, height, 1), width, height);
}

std::vector<float> obstacleDistances(const std::vector<std::uint8_t>& mask, int width, int height) {
  std::vector<float> distances(mask.size());
  DistanceTransform(mask, width, height).forEachRow([&](const DistanceTransform::Row& row) {
    for (int column = 0; column < width; ++column) {
      distances[row.first + static_cast<std::size_t>(column)] = row.distance(column);
    }
  });
  return distances;
}

}  // namespace racecar_mcl
