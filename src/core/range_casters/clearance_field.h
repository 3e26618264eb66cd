// A byte per cell: how far a ray may stride from there.
#pragma once

#include <cstdint>
#include <vector>

#include "range_casters/padded_grid.h"

namespace racecar_mcl {

/// Clearances (see distance_field.h) of the padded cells in whole cells, rounded down. Bytes,
/// because the field then lives in the second-level cache; whole cells, because a finer unit saves
/// 3 % of the strides and costs reach.
class ClearanceField {
 public:
  static constexpr std::uint8_t kLongest = 253;
  static constexpr std::uint8_t kHit = 254;   ///< an obstacle cell
  static constexpr std::uint8_t kMiss = 255;  ///< a cell of the ring where the outside is free

  ClearanceField(const OccupancyGrid& grid, UnknownIs unknown_is);

  const std::uint8_t* data() const { return cells_.data(); }
  std::size_t memoryBytes() const { return cells_.size(); }

 private:
  std::vector<std::uint8_t> cells_;
};

/// The distance in cells from a ray's origin to where it enters the first obstacle cell, at most
/// `limit`.
///
/// From a cell with clearance c a ray can go to where it leaves the cell and c further: every cell
/// on the way is free. Beside an obstacle c is 0 and the walk goes from border to border, so the
/// range is exact.
double walk(const PaddedGrid& grid, const ClearanceField& field, const RayInCells& ray,
            double limit);

}  // namespace racecar_mcl
