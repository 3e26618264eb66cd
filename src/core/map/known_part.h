// The part of a map that holds its known cells.
#pragma once

#include <optional>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// The rectangle of a grid's known cells, with two columns and rows of unknown ones on each side
/// where the grid has them. Since cells outside of a grid count as unknown, all that is derived
/// from the part is the same as that of the whole.
class KnownPart {
 public:
  /// The grid must outlive the part. A grid without a known cell is its own part.
  explicit KnownPart(const OccupancyGrid& whole);

  const OccupancyGrid& grid() const { return part_ ? *part_ : *whole_; }

 private:
  const OccupancyGrid* whole_;
  std::optional<OccupancyGrid> part_;  ///< unless it is the whole
};

}  // namespace racecar_mcl
