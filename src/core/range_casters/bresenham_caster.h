// The reference: visits every cell a ray touches, in order, in double precision.
#pragma once

#include <vector>

#include "racecar_mcl/range_caster.h"
#include "range_casters/padded_grid.h"

namespace racecar_mcl {

/// Walks from cell border to cell border (Amanatides and Woo, "A Fast Voxel Traversal Algorithm for
/// Ray Tracing", 1987), from the pose itself, not from the centre of its cell. It carries the name
/// under which racecar users know the exact method.
class BresenhamCaster : public RangeCaster {
 public:
  BresenhamCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters);

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override;
  std::size_t memoryBytes() const override;

 private:
  PaddedGrid grid_;
  std::vector<std::uint8_t> kinds_;
  double max_range_;
};

}  // namespace racecar_mcl
