// Ray marching on a clearance field, one ray at a time.
#pragma once

#include "racecar_mcl/raycasting/range_caster.h"
#include "raycasting/clearance_field.h"
#include "raycasting/padded_grid.h"

namespace racecar_mcl {

/// Double precision; the scalar counterpart of SimdCaster.
class DistanceTransformCaster : public RangeCaster {
 public:
  DistanceTransformCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters);

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override;
  std::size_t memoryBytes() const override;

 private:
  PaddedGrid grid_;
  ClearanceField field_;
};

}  // namespace racecar_mcl
