// A large random map for benchmarks, similar to the basement of a university building.
#pragma once

#include <cstdint>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl::bench {

/// 1730 x 1300 cells of 0.05 m: corridors 2 to 3 m wide that meet at right angles, rooms with
/// clutter and pillars, alcoves, rough walls two to three cells thick; unknown
/// elsewhere.
OccupancyGrid basementMap(std::uint64_t seed = 1);

}  // namespace racecar_mcl::bench
