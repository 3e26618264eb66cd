#include "sim/map_faults.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "racecar_mcl/map/cell_runs.h"
#include "sim/random_placement.h"
#include "sim/wall_surfaces.h"

namespace racecar_mcl::sim {
namespace {

using Cells = std::vector<std::int8_t>;

constexpr double kGreyWall = 60.0;
constexpr double kGreyNoise = 5.0;
constexpr int kMaxGreyFree = 20;
constexpr double kErasedWallFraction = 0.3;         // of the wall surface
constexpr double kErasedWingFraction = 0.25;        // of the free cells
constexpr double kMovedObjectFraction = 0.3;        // of the isolated objects
constexpr double kAreaPerObject = 25.0;             // m^2 of free space
constexpr double kMinObjectSize = 0.1;              // m; smaller components are noise
constexpr double kMaxObjectSize = 1.5;              // m
constexpr double kMaxDisplacement = 0.05;           // m
constexpr double kMaxRotation = 0.5 * kPi / 180.0;  // rad
constexpr double kWallPerDoor = 15.0;               // m
constexpr int kMinDoors = 4;
constexpr double kDoorGap = 0.9;         // m, in a wall
constexpr double kMinOpening = 0.6;      // m, of an opening
constexpr double kMaxOpening = 1.4;      // m
constexpr double kMinDoorSpacing = 1.5;  // m

OccupancyGrid replaced(const OccupancyGrid& map, Cells cells) {
  return OccupancyGrid(map.geometry(), std::move(cells));
}

/// The cells of each isolated object.
std::vector<std::vector<Cell>> findObjects(const OccupancyGrid& map) {
  const GridGeometry& geometry = map.geometry();
  const CellIndex index(geometry);
  std::vector<std::uint8_t> seen(map.cells().size(), 0);
  std::vector<std::vector<Cell>> objects;
  for (std::size_t first = 0; first < seen.size(); ++first) {
    if (seen[first] != 0 || !isOccupied(map.cells()[first])) continue;
    std::vector<Cell> piece{index.cell(first)};
    seen[first] = 1;
    bool is_isolated = true;
    Cell low = piece[0], high = piece[0];
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const Cell here = piece[k];
      low = {std::min(low.column, here.column), std::min(low.row, here.row)};
      high = {std::max(high.column, here.column), std::max(high.row, here.row)};
      for (const Cell& next : neighbours(here)) {
        const std::int8_t value = map.at(next);
        is_isolated &= value >= 0;
        if (!isOccupied(value) || seen[index(next)] != 0) continue;
        seen[index(next)] = 1;
        piece.push_back(next);
      }
    }
    const double across =
        std::hypot(high.column - low.column + 1, high.row - low.row + 1) * geometry.resolution;
    const bool is_object = across >= kMinObjectSize && across <= kMaxObjectSize;
    if (is_isolated && is_object) objects.push_back(std::move(piece));
  }
  return objects;
}

void shuffle(std::vector<std::vector<Cell>>* objects, Random& random) {
  for (std::size_t i = objects->size(); i > 1; --i) {
    std::swap((*objects)[i - 1], (*objects)[random.index(i)]);
  }
}

/// The object's cells, moved by 0.3 to 1 m into free space; empty if there is none.
std::vector<Cell> moved(const std::vector<Cell>& object, const OccupancyGrid& map, Random& random) {
  const auto isOwn = [&](const Cell& cell) {
    return std::find(object.begin(), object.end(), cell) != object.end();
  };
  for (int attempt = 0; attempt < 100; ++attempt) {
    const double distance = random.uniform(0.3, 1.0) / map.geometry().resolution;
    const double yaw = random.uniform(-kPi, kPi);
    const auto columns = static_cast<int>(std::lround(distance * std::cos(yaw)));
    const auto rows = static_cast<int>(std::lround(distance * std::sin(yaw)));
    std::vector<Cell> there;
    bool fits = true;
    for (const Cell& cell : object) {
      there.push_back({cell.column + columns, cell.row + rows});
      for (const Cell& near : neighbours(there.back())) fits &= map.isFree(near) || isOwn(near);
      if (!fits) break;
    }
    if (fits) return there;
  }
  return {};
}

/// An opening between two walls.
struct Opening {
  Eigen::Vector2d middle;  ///< in the map frame
  Eigen::Vector2d half;    ///< from the middle to the wall on one side
};

/// The narrowest passage between walls through a point, if it is an opening: as wide as a door,
/// deeper than a corner on both sides, and wider beyond on one side.
std::optional<Opening> openingAt(const World& map, const Eigen::Vector2d& point) {
  constexpr double kDepth = 0.6;  // relative to its width; a right-angled corner has 0.5
  const auto wayTo = [&](const Eigen::Vector2d& from, double yaw) {
    return map.castWalls(from, yaw, 2.0 * kMaxOpening, Ends::kWhereNotFree);
  };
  double narrowest = kMaxOpening;
  double across = 0.0;  // rad
  double left = 0.0, right = 0.0;
  for (int i = 0; i < 36; ++i) {
    const double yaw = kPi * i / 36.0;
    const double one = wayTo(point, yaw);
    const double other = wayTo(point, yaw + kPi);
    if (one + other >= narrowest) continue;
    narrowest = one + other;
    across = yaw;
    left = one;
    right = other;
  }
  if (narrowest >= kMaxOpening || narrowest < kMinOpening) return std::nullopt;
  const auto endsAtWall = [&](double yaw, double way) {
    return map.castWalls(point, yaw, 2.0 * kMaxOpening) <= way;
  };
  if (!endsAtWall(across, left) || !endsAtWall(across + kPi, right)) return std::nullopt;
  const Eigen::Vector2d direction(std::cos(across), std::sin(across));
  const Eigen::Vector2d middle = point + (left - right) / 2.0 * direction;
  bool widens = false;
  for (const double ahead : {across + kPi / 2.0, across - kPi / 2.0}) {
    if (wayTo(middle, ahead) < kDepth * narrowest) return std::nullopt;
    const Eigen::Vector2d beyond =
        middle + kDepth / 2.0 * narrowest * Eigen::Vector2d(std::cos(ahead), std::sin(ahead));
    widens |= wayTo(beyond, across) + wayTo(beyond, across + kPi) > 1.3 * narrowest;
  }
  if (!widens) return std::nullopt;
  return Opening{middle, narrowest / 2.0 * direction};
}

/// The map without isolated objects: the passage between an object and a wall is not an opening.
OccupancyGrid wallsOnly(const OccupancyGrid& map) {
  const CellIndex index(map.geometry());
  Cells cells = map.cells();
  for (const std::vector<Cell>& object : findObjects(map)) {
    for (const Cell& cell : object) cells[index(cell)] = OccupancyGrid::kFree;
  }
  return replaced(map, std::move(cells));
}

/// Closes up to `count` openings with a minimum spacing; returns their number.
int closeOpenings(const OccupancyGrid& map, int count, Random& random, Cells* cells) {
  const World world(wallsOnly(map));
  const CellIndex index(map.geometry());
  std::vector<Eigen::Vector2d> doors;
  for (int attempt = 0; attempt < kPlacementAttempts && static_cast<int>(doors.size()) < count;
       ++attempt) {
    const auto opening = openingAt(world, world.randomFreePoint(random));
    if (!opening) continue;
    const bool apart = std::all_of(doors.begin(), doors.end(), [&](const Eigen::Vector2d& door) {
      return (door - opening->middle).norm() > kMinDoorSpacing;
    });
    if (!apart) continue;
    doors.push_back(opening->middle);
    const double step = map.geometry().resolution / 4.0 / opening->half.norm();
    for (double way = -1.0; way <= 1.0; way += step) {
      const Cell cell = cellAt(map.geometry(), opening->middle + way * opening->half);
      if (map.isFree(cell)) (*cells)[index(cell)] = OccupancyGrid::kOccupied;
    }
  }
  return static_cast<int>(doors.size());
}

}  // namespace

OccupancyGrid fillUnknown(const OccupancyGrid& map) {
  Cells cells = map.cells();
  std::replace(cells.begin(), cells.end(), OccupancyGrid::kUnknown, OccupancyGrid::kOccupied);
  return replaced(map, std::move(cells));
}

OccupancyGrid greyCells(const OccupancyGrid& map, Random& random) {
  Cells cells = map.cells();
  for (std::int8_t& cell : cells) {
    if (cell < 0) continue;
    const double grey = isOccupied(cell) ? kGreyWall + kGreyNoise * random.gaussian()
                                         : static_cast<double>(random.index(kMaxGreyFree + 1));
    cell = static_cast<std::int8_t>(std::clamp(std::lround(grey), 0L, 100L));
  }
  return replaced(map, std::move(cells));
}

OccupancyGrid eraseWalls(const OccupancyGrid& map, double fraction, Random& random) {
  WallSurfaces walls(map);
  const std::size_t all = walls.surface().size();
  while (walls.surfaceLeft() > 0 &&
         static_cast<double>(walls.surfaceLeft()) > (1.0 - fraction) * static_cast<double>(all)) {
    const std::size_t centre = walls.surface()[random.index(all)];
    if (walls.isErased(centre)) continue;
    walls.erase(centre, random.uniform(1.0, 3.0));
  }
  return replaced(map, walls.cells());
}

OccupancyGrid eraseWing(const OccupancyGrid& map, double fraction, Random& random) {
  const double yaw = random.uniform(-kPi, kPi);
  const auto along = [&](const Cell& cell) {
    return cell.column * std::cos(yaw) + cell.row * std::sin(yaw);
  };
  std::vector<double> places;
  for (const Cell& cell : freeCells(map).cells()) places.push_back(along(cell));
  if (places.empty()) return map;
  std::sort(places.begin(), places.end());
  const auto kept = static_cast<std::size_t>((1.0 - fraction) * static_cast<double>(places.size()));
  const double line = places[std::min(kept, places.size() - 1)];
  const CellIndex index(map.geometry());
  Cells cells = map.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (along(index.cell(i)) >= line) cells[i] = OccupancyGrid::kUnknown;
  }
  return replaced(map, std::move(cells));
}

int countObjects(const OccupancyGrid& map) { return static_cast<int>(findObjects(map).size()); }

OccupancyGrid moveObjects(const OccupancyGrid& map, double fraction, Random& random) {
  std::vector<std::vector<Cell>> objects = findObjects(map);
  shuffle(&objects, random);
  const CellIndex index(map.geometry());
  OccupancyGrid changed = map;
  auto to_move = static_cast<int>(std::ceil(fraction * static_cast<double>(objects.size()) - 1e-9));
  for (const std::vector<Cell>& object : objects) {
    if (to_move == 0) break;
    const std::vector<Cell> there = moved(object, changed, random);
    if (there.empty()) continue;
    Cells cells = changed.cells();
    for (const Cell& cell : object) cells[index(cell)] = OccupancyGrid::kFree;
    for (const Cell& cell : there) cells[index(cell)] = OccupancyGrid::kOccupied;
    changed = replaced(map, std::move(cells));
    --to_move;
  }
  return changed;
}

OccupancyGrid changeDoors(const OccupancyGrid& map, Random& random) {
  WallSurfaces walls(map);
  const std::size_t all = walls.surface().size();
  if (all == 0) return map;
  const double length = static_cast<double>(all) * map.geometry().resolution;
  const int doors = std::max(kMinDoors, static_cast<int>(length / kWallPerDoor));
  Cells closed = map.cells();
  const int to_open = doors - closeOpenings(map, doors / 2, random, &closed);
  for (int i = 0; i < to_open; ++i) walls.erase(walls.surface()[random.index(all)], kDoorGap);
  // Closed openings stay closed if a wall next to them is erased.
  Cells cells = walls.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (closed[i] != map.cells()[i]) cells[i] = closed[i];
  }
  return replaced(map, std::move(cells));
}

OccupancyGrid distort(const OccupancyGrid& map, double max_displacement, double max_rotation,
                      Random& random) {
  // Displacement u_i = a sin(k d_i . p + phase_i), i = x, y, with |u| <= sqrt(2) a. A line along
  // the unit vector e with normal n rotates by sum n_i (k a cos(...) d_i . e) <= sqrt(2) k a.
  const double amplitude = max_displacement / std::sqrt(2.0);                       // m
  const double wave = max_rotation / max_displacement * map.geometry().resolution;  // rad per cell
  Eigen::Vector2d directions[2];
  double phases[2];
  for (int i = 0; i < 2; ++i) {
    const double yaw = random.uniform(-kPi, kPi);
    directions[i] = {std::cos(yaw), std::sin(yaw)};
    phases[i] = random.uniform(-kPi, kPi);
  }
  const auto displacement = [&](const Cell& cell) {  // in cells
    const Eigen::Vector2d place(cell.column, cell.row);
    const Eigen::Vector2d offset(std::sin(wave * directions[0].dot(place) + phases[0]),
                                 std::sin(wave * directions[1].dot(place) + phases[1]));
    const Eigen::Vector2d cells = amplitude / map.geometry().resolution * offset;
    return Cell{static_cast<int>(std::lround(cells.x())), static_cast<int>(std::lround(cells.y()))};
  };
  const CellIndex index(map.geometry());
  Cells cells(map.cells().size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell here = index.cell(i);
    const Cell by = displacement(here);
    cells[i] = map.at({here.column - by.column, here.row - by.row});
  }
  // Where the map shrinks, some cells have no target. Forward mapping keeps walls one cell thick.
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!isOccupied(map.cells()[i])) continue;
    const Cell from = index.cell(i);
    const Cell by = displacement(from);
    const Cell there{from.column + by.column, from.row + by.row};
    if (contains(map.geometry(), there)) cells[index(there)] = map.cells()[i];
  }
  return replaced(map, std::move(cells));
}

OccupancyGrid withObstacles(const OccupancyGrid& map, const std::vector<Obstacle>& obstacles,
                            double time) {
  const CellIndex index(map.geometry());
  Cells cells = map.cells();
  for (const Obstacle& obstacle : obstacles) {
    const Pose2 obstacle_in_map = poseAt(obstacle, time);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Eigen::Vector2d centre = cellCentre(map.geometry(), index.cell(i));
      if (castObstacle(obstacle, obstacle_in_map, centre, Eigen::Vector2d::UnitX()) > 0.0) continue;
      cells[i] = OccupancyGrid::kOccupied;
    }
  }
  return replaced(map, std::move(cells));
}

const std::map<std::string, MapFault>& mapFaults() {
  static const std::map<std::string, MapFault> faults = {
      {"none", MapFault::kNone},
      {"filled", MapFault::kFilled},
      {"grey", MapFault::kGrey},
      {"erased_walls", MapFault::kErasedWalls},
      {"erased_wing", MapFault::kErasedWing},
      {"moved_objects", MapFault::kMovedObjects},
      {"doors", MapFault::kDoors},
      {"distorted", MapFault::kDistorted},
  };
  return faults;
}

WrongMap makeWrongMap(MapFault fault, const OccupancyGrid& map, const World& world,
                      const Pose2& keep_clear, Random& random) {
  switch (fault) {
    case MapFault::kNone:
      break;
    case MapFault::kFilled:
      return {fillUnknown(map), {}};
    case MapFault::kGrey:
      return {greyCells(map, random), {}};
    case MapFault::kErasedWalls:
      return {eraseWalls(map, kErasedWallFraction, random), {}};
    case MapFault::kErasedWing:
      return {eraseWing(map, kErasedWingFraction, random), {}};
    case MapFault::kMovedObjects: {
      const auto enough = static_cast<int>(world.freeArea() / kAreaPerObject);
      const int lacking = std::max(0, enough - countObjects(map));
      std::vector<Obstacle> boxes = placeBoxes(world, lacking, keep_clear, random);
      return {moveObjects(withObstacles(map, boxes, 0.0), kMovedObjectFraction, random), boxes};
    }
    case MapFault::kDoors:
      return {changeDoors(map, random), {}};
    case MapFault::kDistorted:
      return {distort(map, kMaxDisplacement, kMaxRotation, random), {}};
  }
  return {map, {}};
}

}  // namespace racecar_mcl::sim
