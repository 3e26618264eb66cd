// Lossless map files for map_server and `loadMap`.
#pragma once

#include <string>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl::sim {

/// Binary PGM: free cells white, occupied grey, unknown black.
std::string toPgm(const OccupancyGrid& map);

/// The YAML file, in mode `raw`, the only one that keeps all values and unknown cells.
std::string toMapYaml(const OccupancyGrid& map, const std::string& image_name);

}  // namespace racecar_mcl::sim
