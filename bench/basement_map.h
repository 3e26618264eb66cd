// A map to measure on: large, seeded, and like the basement of a university building.
#pragma once

#include <cstdint>

#include "racecar_mcl/occupancy_grid.h"

namespace racecar_mcl::bench {

/// 1730 x 1300 cells of 0.05 m: corridors 2 to 3 m wide that meet at right angles, rooms with
/// clutter and pillars, alcoves, walls two to three cells thick with the roughness of a mapped
/// wall; unknown elsewhere.
OccupancyGrid basementMap(std::uint64_t seed = 1);

}  // namespace racecar_mcl::bench
