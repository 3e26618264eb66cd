// Texts of a map summary.
#pragma once

#include <string>
#include <vector>

#include "racecar_mcl/map/map_summary.h"

namespace racecar_mcl {

/// The warnings for a summary, one line each; the summary's own `warnings` are not used.
/// `has_visible_walls`: at least one obstacle cell is next to free space.
std::vector<std::string> warningsOf(const MapSummary& summary, bool has_visible_walls);

}  // namespace racecar_mcl
