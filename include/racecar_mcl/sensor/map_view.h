// The parts of a map that single beams are compared with.
#pragma once

#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/raycasting/range_caster.h"
#include "racecar_mcl/sensor/likelihood_field.h"

namespace racecar_mcl {

/// Non-owning.
struct MapView {
  const OccupancyGrid& grid;
  const RangeCaster& caster;     ///< exact, without a cache
  const LikelihoodField& field;  ///< with coarseFieldParameters, for distances from surfaces
};

}  // namespace racecar_mcl
