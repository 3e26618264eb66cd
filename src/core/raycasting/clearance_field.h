// Clearance field for ray marching: one byte per cell.
#pragma once

#include <cstdint>
#include <vector>

#include "raycasting/padded_grid.h"

namespace racecar_mcl {

/// Clearances (see distance_field.h) of the padded cells in whole cells, rounded down. With bytes
/// the field fits into the second-level cache; a finer unit would save 3 % of the steps, but limit
/// the largest step.
class ClearanceField {
 public:
  static constexpr std::uint8_t kMaxClearance = 253;
  static constexpr std::uint8_t kHit = 254;   ///< an obstacle cell
  static constexpr std::uint8_t kMiss = 255;  ///< a cell of the ring if the outside is free

  ClearanceField(const OccupancyGrid& grid, UnknownIs unknown_is);

  const std::uint8_t* data() const { return cells_.data(); }
  std::size_t memoryBytes() const { return cells_.size(); }

 private:
  std::vector<std::uint8_t> cells_;
};

/// Ray marching (sphere tracing on a distance field): the distance in cells from a ray's origin to
/// where it enters the first obstacle cell, at most `limit`.
///
/// From a cell with clearance c a ray can advance to the border where it leaves the cell and c
/// cells further, since all cells in between are free. Next to an obstacle c is 0 and the ray
/// advances from border to border, so that the range is exact.
double marchRay(const PaddedGrid& grid, const ClearanceField& field, const RayInCells& ray,
                double limit);

}  // namespace racecar_mcl
