// Typical map errors, for the map of the localizer; the simulated world is unchanged.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "sim/obstacle.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// All unknown cells become occupied, as in solid drawings of race tracks.
OccupancyGrid fillUnknown(const OccupancyGrid& map);

/// Walls at 60 of 100 with a standard deviation of 5, free cells uniform from 0 to 20, as in maps
/// that are not trinary.
OccupancyGrid greyCells(const OccupancyGrid& map, Random& random);

/// Erases `fraction` of the wall surface (cells next to free ones) in segments of 1 to 3 m,
/// including the wall behind it. The cells become free if both sides are free, else unknown. Walls
/// thicker than 1 m lose 1 m.
OccupancyGrid eraseWalls(const OccupancyGrid& map, double fraction, Random& random);

/// The cells on one side of a line, with `fraction` of the free cells, become unknown.
OccupancyGrid eraseWing(const OccupancyGrid& map, double fraction, Random& random);

/// Moves `fraction` of the isolated objects (see `countObjects`), at least one, by 0.3 to 1 m into
/// free space, if there is any.
OccupancyGrid moveObjects(const OccupancyGrid& map, double fraction, Random& random);

/// The number of occupied components of 0.1 to 1.5 m that are surrounded by free cells.
int countObjects(const OccupancyGrid& map);

/// One change per 15 m of walls, at least four: up to half of them close openings of 0.6 to 1.4 m,
/// the others make gaps of 0.9 m in walls.
OccupancyGrid changeDoors(const OccupancyGrid& map, Random& random);

/// Smooth distortion with displacements up to `max_displacement` m and rotations up to
/// `max_rotation` rad, before rounding to cells.
OccupancyGrid distort(const OccupancyGrid& map, double max_displacement, double max_rotation,
                      Random& random);

/// The map with these obstacles at `time` (s).
OccupancyGrid withObstacles(const OccupancyGrid& map, const std::vector<Obstacle>& obstacles,
                            double time);

enum class MapFault {
  kNone,
  kFilled,
  kGrey,
  kErasedWalls,
  kErasedWing,
  kMovedObjects,
  kDoors,
  kDistorted
};

/// Names of the faults on command lines.
const std::map<std::string, MapFault>& mapFaults();

/// The localizer's map, and obstacles to add to the world.
struct WrongMap {
  OccupancyGrid map;
  std::vector<Obstacle> boxes;
};

/// Default magnitudes: 30 % of walls or objects, 25 % of the free cells, 5 cm and 0.5 degrees. For
/// `kMovedObjects`, boxes are added to the world and to the map, if there is room, until there is
/// one object per 25 m^2 of free space; then objects are moved in the map only. Boxes keep clear of
/// `keep_clear`.
WrongMap makeWrongMap(MapFault fault, const OccupancyGrid& map, const World& world,
                      const Pose2& keep_clear, Random& random);

}  // namespace racecar_mcl::sim
