// Vectorized ray marching: the inner loop of SimdCaster, compiled once per instruction set.
#pragma once

#include "racecar_mcl/raycasting/range_caster.h"
#include "raycasting/clearance_field.h"
#include "raycasting/padded_grid.h"
#include "simd/cpu_dispatch.h"

namespace racecar_mcl {

/// The poses of a batch that are cast: all, or `count` listed ones.
struct PoseSelection {
  const Eigen::Index* indices = nullptr;
  Eigen::Index count = 0;

  Eigen::Index operator[](Eigen::Index i) const { return indices == nullptr ? i : indices[i]; }
};

/// Inputs and output of a march.
struct MarchTask {
  const PaddedGrid& grid;
  const ClearanceField& field;
  double limit;  ///< cells; longer ranges are written as the cast's max_range
  double max_range;
  const PoseBatch& lidar_in_map;
  const PoseSelection& selection;
  const Eigen::ArrayXf& bearings;
  Eigen::Ref<Eigen::ArrayXXf>& ranges;
};

/// Whether single precision and 32-bit indices suffice for a map and a limit: false for maps of
/// about 30,000 x 30,000 cells and for limits over 16,384 cells.
bool marchSupports(const PaddedGrid& grid, double limit);

/// Casts all finite bearings from the selected poses that are inside the map; other ranges are
/// unchanged. Results are bit-identical for every instruction set. Returns whether all selected
/// poses are inside the map.
bool march(InstructionSet set, const MarchTask& task);

}  // namespace racecar_mcl
