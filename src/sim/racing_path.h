// Smooth path around a closed corridor of a map.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl::sim {

/// A polyline in the map frame, m.
using Path = std::vector<Eigen::Vector2d>;

/// The path with the least sum of squared second differences (accelerations, if its points are
/// passed at equal times) that keeps `clearance` m from cells that are not known to be free:
/// smooth, and short in curves. It passes all obstacles on the same side as `lap`, a rough closed
/// lap. Closed, with points about 0.1 m apart. Throws MapError if the corridor is too narrow,
/// ParameterError if the lap is shorter than 5 m.
Path racingPath(const OccupancyGrid& map, const Path& lap, double clearance);

}  // namespace racecar_mcl::sim
