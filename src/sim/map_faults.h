// Maps that are wrong in the ways in which maps are. The localizer gets them; the world stays as it
// is.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/random.h"
#include "sim/obstacle.h"
#include "sim/world.h"

namespace racecar_mcl::sim {

/// Every unknown cell occupied, as in maps of race tracks that are drawn solid.
OccupancyGrid fillUnknown(const OccupancyGrid& map);

/// Walls at 60 of 100, with a noise of 5, and free cells evenly from 0 to 20, as in maps that are
/// not trinary.
OccupancyGrid greyCells(const OccupancyGrid& map, Random& random);

/// `share` of the walls' surface, counted in cells that border on free ones, taken away in
/// stretches of 1 to 3 m, with the wall behind it. There, the map holds what lies behind: unknown
/// cells, or free ones where both sides are free. A wall more than 1 m thick loses 1 m.
OccupancyGrid eraseWalls(const OccupancyGrid& map, double share, Random& random);

/// Everything on one side of a line becomes unknown, with `share` of the free cells.
OccupancyGrid eraseWing(const OccupancyGrid& map, double share, Random& random);

/// `share` of the things that stand free (see `countObjects`), at least one, moved by 0.3 to 1 m to
/// where there is room for them. Things without room stay.
OccupancyGrid moveObjects(const OccupancyGrid& map, double share, Random& random);

/// How many occupied pieces 0.1 to 1.5 m across have free cells all round.
int countObjects(const OccupancyGrid& map);

/// One change for each 15 m of walls, at least four: for up to half of them, openings 0.6 to 1.4 m
/// wide are closed, as far as there are any; for the rest, gaps of 0.9 m are made in walls.
OccupancyGrid changeDoors(const OccupancyGrid& map, Random& random);

/// Stretched and bent smoothly: no place is more than `most` m off, and no line turned by more than
/// `most_turn` rad, before all that is rounded to cells.
OccupancyGrid distort(const OccupancyGrid& map, double most, double most_turn, Random& random);

/// The map with these obstacles drawn where they stand at `time` (s).
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

/// By the names that programs know them by.
const std::map<std::string, MapFault>& mapFaults();

/// What a localizer is given, and what stands in the world besides.
struct WrongMap {
  OccupancyGrid map;
  std::vector<Obstacle> boxes;
};

/// The fault as strong as it is by default: 30 % of the walls or of the things, a quarter of the
/// free cells, 5 cm and half a degree. Only for `kMovedObjects` do boxes stand in the world: those
/// that the map lacks to one thing for each 25 m^2 of free space, as far as there is room for them.
/// The right map would show them; in the wrong one some are moved, as the rest. They stand clear of
/// `keep_clear`.
WrongMap makeWrongMap(MapFault fault, const OccupancyGrid& map, const World& world,
                      const Pose2& keep_clear, Random& random);

}  // namespace racecar_mcl::sim
