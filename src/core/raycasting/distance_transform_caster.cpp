#include "raycasting/distance_transform_caster.h"

#include "raycasting/cast_each.h"

namespace racecar_mcl {

DistanceTransformCaster::DistanceTransformCaster(const OccupancyGrid& grid,
                                                 const RangeCasterParameters& parameters)
    : RangeCaster(parameters.max_range),
      grid_(grid.geometry(), parameters.unknown_is),
      field_(grid, parameters.unknown_is) {}

void DistanceTransformCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                                   Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  castEach(
      grid_, maxRange(), lidar_in_map, bearings, ranges,
      [&](const RayInCells& ray, double limit) { return marchRay(grid_, field_, ray, limit); });
}

std::size_t DistanceTransformCaster::memoryBytes() const {
  return sizeof(*this) + field_.memoryBytes();
}

}  // namespace racecar_mcl
