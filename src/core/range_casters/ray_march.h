// Many rays at once: the inner loop of SimdCaster, compiled once per instruction set.
#pragma once

#include "instruction_set.h"
#include "racecar_mcl/range_caster.h"
#include "range_casters/clearance_field.h"
#include "range_casters/padded_grid.h"

namespace racecar_mcl {

/// The poses of a batch that are to be cast: all, or `count` listed ones.
struct PoseSelection {
  const Eigen::Index* which = nullptr;
  Eigen::Index count = 0;

  Eigen::Index operator[](Eigen::Index i) const { return which == nullptr ? i : which[i]; }
};

/// Everything a march reads, and where it writes.
struct MarchOrder {
  const PaddedGrid& grid;
  const ClearanceField& field;
  double limit;  ///< cells; longer ranges are written as the cast's max_range
  double max_range;
  const PoseBatch& lidar_in_map;
  const PoseSelection& selection;
  const Eigen::ArrayXf& bearings;
  Eigen::Ref<Eigen::ArrayXXf>& ranges;
};

/// Whether single precision and 32-bit indices serve for a map and a limit: false for maps of some
/// 30,000 cells square, and limits over 16,384 cells.
bool marchServes(const PaddedGrid& grid, double limit);

/// Casts all finite bearings from those selected poses that lie in the map, and leaves the other
/// ranges as they are. Every instruction set gives the same bits. Returns whether all selected
/// poses lay in the map.
bool march(InstructionSet set, const MarchOrder& order);

}  // namespace racecar_mcl
