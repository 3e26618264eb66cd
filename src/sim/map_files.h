// A map as files that map_server and `loadMap` read back as it was.
#pragma once

#include <string>

#include "racecar_mcl/occupancy_grid.h"

namespace racecar_mcl::sim {

/// The image, a binary PGM: free cells white, occupied ones grey, unknown ones black.
std::string toPgm(const OccupancyGrid& map);

/// The YAML beside it. Mode `raw`, which alone keeps every value and the unknown cells.
std::string toMapYaml(const OccupancyGrid& map, const std::string& image_name);

}  // namespace racecar_mcl::sim
