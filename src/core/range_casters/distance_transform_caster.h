// Strides as far as the nearest obstacle allows, and stops exactly on the border of the cell it
// hits.
#pragma once

#include <vector>

#include "racecar_mcl/range_caster.h"
#include "range_casters/padded_grid.h"

namespace racecar_mcl {

/// From a cell with clearance c (see distance_field.h) a ray can go to the cell's border and c
/// further: every cell on the way is free. Beside an obstacle c is 0 and the walk goes from border
/// to border, so the range is exact.
class DistanceTransformCaster : public RangeCaster {
 public:
  DistanceTransformCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters);

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override;
  std::size_t memoryBytes() const override;

 private:
  double walk(const RayInCells& ray, double limit) const;

  PaddedGrid grid_;
  double max_range_;
  std::vector<float> field_;  ///< clearance in cells; negative where a ray ends
};

}  // namespace racecar_mcl
