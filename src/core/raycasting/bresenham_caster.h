// Reference ray caster: visits every cell on a ray, in order, in double precision.
#pragma once

#include <vector>

#include "racecar_mcl/raycasting/range_caster.h"
#include "raycasting/padded_grid.h"

namespace racecar_mcl {

/// Grid traversal from cell border to cell border (Amanatides and Woo, "A Fast Voxel Traversal
/// Algorithm for Ray Tracing", 1987), from the exact pose instead of the centre of its cell. The
/// name is the one used by range_libc for the exact method.
class BresenhamCaster : public RangeCaster {
 public:
  BresenhamCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters);

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override;
  std::size_t memoryBytes() const override;

 private:
  PaddedGrid grid_;
  std::vector<std::uint8_t> kinds_;
};

}  // namespace racecar_mcl
