// The distance field walked by many rays at once, in the widest vectors the processor has.
#pragma once

#include "racecar_mcl/range_caster.h"
#include "range_casters/clearance_field.h"
#include "range_casters/padded_grid.h"
#include "range_casters/ray_march.h"

namespace racecar_mcl {

/// The algorithm of DistanceTransformCaster in single precision: within 0.001 cell of it, but for
/// the few rays in 100,000 that clip a corner by less than 0.0003 cell. Allocates nothing while
/// casting.
class SimdCaster : public RangeCaster {
 public:
  SimdCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters);
  SimdCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters,
             InstructionSet instruction_set);

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override;
  std::size_t memoryBytes() const override;

  /// Casts from the selected poses only, and leaves the other columns of `ranges` as they are.
  void castSelected(const PoseBatch& lidar_in_map, const PoseSelection& selection,
                    const Eigen::ArrayXf& bearings, Eigen::Ref<Eigen::ArrayXXf> ranges) const;

  const PaddedGrid& grid() const { return grid_; }

 private:
  PaddedGrid grid_;
  ClearanceField field_;
  double max_range_;
  InstructionSet instruction_set_;
};

}  // namespace racecar_mcl
