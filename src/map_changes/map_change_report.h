// Changes of a map as text and as CSV.
#pragma once

#include <string>

#include "map_changes/map_changes.h"

namespace racecar_mcl {

/// The numbers of cells, and a table with a line per region.
std::string changesText(const MapChanges& changes);

/// One row per region, in the order of the table; m in the map frame, sizes along the grid.
std::string changesCsv(const MapChanges& changes);

}  // namespace racecar_mcl
