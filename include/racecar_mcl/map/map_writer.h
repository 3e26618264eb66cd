// Writes maps in map_server's format.
#pragma once

#include <string>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// A binary PGM in mode trinary, as map_saver writes it: free, occupied or unknown.
std::string toTrinaryPgm(const OccupancyGrid& map);

/// The YAML file that belongs to toTrinaryPgm.
std::string toTrinaryYaml(const GridGeometry& geometry, const std::string& image_name);

}  // namespace racecar_mcl
