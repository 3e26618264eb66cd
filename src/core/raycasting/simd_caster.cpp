#include "raycasting/simd_caster.h"

#include <algorithm>
#include <cmath>

#include "raycasting/cast_each.h"

namespace racecar_mcl {

SimdCaster::SimdCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters)
    : SimdCaster(grid, parameters, fastestInstructionSet()) {}

SimdCaster::SimdCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters,
                       InstructionSet instruction_set)
    : RangeCaster(parameters.max_range),
      grid_(grid.geometry(), parameters.unknown_is),
      field_(grid, parameters.unknown_is),
      instruction_set_(instruction_set) {}

void SimdCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                      Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  castSelected(lidar_in_map, {nullptr, lidar_in_map.size}, bearings, ranges);
}

void SimdCaster::castSelected(const PoseBatch& lidar_in_map, const PoseSelection& selection,
                              const Eigen::ArrayXf& bearings,
                              Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  requireShape(lidar_in_map, bearings, ranges);
  for (Eigen::Index i = 0; i < selection.count; ++i) {
    ranges.col(selection[i]).setConstant(static_cast<float>(maxRange()));
  }
  // No ray inside the map is longer than its diagonal.
  const double limit =
      std::min(maxRange() / grid_.resolution(), std::hypot(grid_.width(), grid_.height()));
  const bool is_supported = marchSupports(grid_, limit);
  if (is_supported && march(instruction_set_, {grid_, field_, limit, maxRange(), lidar_in_map,
                                               selection, bearings, ranges})) {
    return;
  }
  for (Eigen::Index i = 0; i < selection.count; ++i) {
    const Eigen::Index pose = selection[i];
    if (is_supported && grid_.contains(grid_.position(lidar_in_map.pose(pose)))) continue;
    castEach(
        grid_, maxRange(), lidar_in_map.segment(pose, 1), bearings, ranges.middleCols(pose, 1),
        [&](const RayInCells& ray, double rest) { return marchRay(grid_, field_, ray, rest); });
  }
}

std::size_t SimdCaster::memoryBytes() const { return sizeof(*this) + field_.memoryBytes(); }

}  // namespace racecar_mcl
