// Writes maps in map_server's format.
#pragma once

#include <string>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// Modes of map_server.
enum class MapMode {
  kTrinary,  ///< free, occupied or unknown, as map_saver writes it
  kRaw,      ///< the only one that keeps all values; free cells are white, unknown ones black
};

/// A binary PGM.
std::string toPgm(const OccupancyGrid& map, MapMode mode);

/// The YAML file that belongs to the PGM of this name.
std::string toMapYaml(const GridGeometry& geometry, const std::string& image_name, MapMode mode);

}  // namespace racecar_mcl
