// The place the simulated car drives in: walls on fine cells, and things that stand or move about
// unmapped.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/random.h"
#include "sim/obstacle.h"

namespace racecar_mcl::sim {

/// Parts of the walls that a lidar sees nothing in. The walls are parted into patches of `patch` x
/// `patch` m, of which `share` (0 to 1), chosen by `seed`, are glass. A car still bumps into it.
struct Glass {
  double share = 0.0;
  double patch = 0.6;  ///< m
  std::uint64_t seed = 1;
};

/// What ends a ray. The localizer's rays pass through unknown cells and out of the grid by default
/// (`unknown_is: free`), and so do the lidar's. What is not known to be free cannot be driven.
enum class Ends {
  kAtWalls,
  kWhereNotFree,  ///< at a wall, an unknown cell or the grid's edge
};

/// Where a ray ends.
struct Hit {
  double range = 0.0;  ///< m from the ray's origin; +infinity where it meets nothing
  bool on_wall = false;
};

/// The walls. Rays are cast by an exact traversal of the cells in double precision (Amanatides and
/// Woo, 1987), written for the simulator alone, so that agreement with the localizer's casters
/// means something.
class World {
 public:
  /// A cell is a wall from OccupancyGrid::kObstacleFrom on; the outside is unknown. The grid may be
  /// as fine as one likes; splitting the cells of a coarse map would change no range and is left
  /// undone.
  explicit World(const OccupancyGrid& grid);

  const GridGeometry& geometry() const { return geometry_; }

  /// Distance from `origin` to the entry of the first cell that ends a ray in direction `yaw` (rad,
  /// map frame): 0 from inside such a cell, +infinity where there is none within `max_range`.
  double castWalls(const Eigen::Vector2d& origin, double yaw, double max_range,
                   Ends ends = Ends::kAtWalls) const;

  /// The nearer of the walls and of the obstacles as they stand at `time` (s).
  Hit cast(const Eigen::Vector2d& origin, double yaw, double max_range,
           const std::vector<Obstacle>& obstacles, double time, Ends ends = Ends::kAtWalls) const;

  bool isWall(const Eigen::Vector2d& point) const;

  /// Known to be free: not a wall, not unknown, not outside.
  bool isFree(const Eigen::Vector2d& point) const;

  /// m^2 of known free space.
  double freeArea() const;

  /// Whether the wall at `point` is glass.
  static bool isGlass(const Glass& glass, const Eigen::Vector2d& point);

  /// A point of free (known) space, uniformly at random. Throws MapError where there is none.
  Eigen::Vector2d randomFreePoint(Random& random) const;

 private:
  std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(geometry_.width) +
           static_cast<std::size_t>(cell.column);
  }

  GridGeometry geometry_;
  std::vector<std::uint8_t> cells_;  ///< free, unknown or wall; row-major, lowest row first
  std::vector<std::uint32_t> free_;  ///< indices of the free cells, rising
};

/// The world that belongs to a map file: `<map>_world.yaml` beside it where there is one, else the
/// map itself. The path only; nothing is read.
std::string worldPathFor(const std::string& map_yaml_path);

/// The pose in `<map>_start.yaml` (`start: [x, y, yaw]`, m and rad in the map frame). Returns false
/// where the map has no such file; throws MapError on one that does not read so.
bool loadStartPose(const std::string& map_yaml_path, Pose2& start_in_map);

}  // namespace racecar_mcl::sim
