#include "range_casters/distance_transform_caster.h"

#include "range_casters/cast_each.h"

namespace racecar_mcl {

DistanceTransformCaster::DistanceTransformCaster(const OccupancyGrid& grid,
                                                 const RangeCasterParameters& parameters)
    : grid_(grid.geometry(), parameters.unknown_is),
      field_(grid, parameters.unknown_is),
      max_range_(parameters.max_range) {}

void DistanceTransformCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                                   Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  castEach(grid_, max_range_, lidar_in_map, bearings, ranges,
           [&](const RayInCells& ray, double limit) { return walk(grid_, field_, ray, limit); });
}

std::size_t DistanceTransformCaster::memoryBytes() const {
  return sizeof(*this) + field_.memoryBytes();
}

}  // namespace racecar_mcl
