// Strides as far as the nearest obstacle allows, and stops exactly on the border of the cell it
// hits.
#pragma once

#include "racecar_mcl/range_caster.h"
#include "range_casters/clearance_field.h"
#include "range_casters/padded_grid.h"

namespace racecar_mcl {

/// One ray after the other, in double precision: the plain sibling of SimdCaster.
class DistanceTransformCaster : public RangeCaster {
 public:
  DistanceTransformCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters);

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override;
  std::size_t memoryBytes() const override;

 private:
  PaddedGrid grid_;
  ClearanceField field_;
  double max_range_;
};

}  // namespace racecar_mcl
