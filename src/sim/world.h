// The simulated world: walls on a fine grid, and unmapped obstacles.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/map/occupancy_grid.h"
#include "sim/obstacle.h"

namespace racecar_mcl::sim {

/// Wall patches without lidar returns. Walls are divided into patches of `patch` x `patch` m, of
/// which a fraction `share`, selected by `seed`, is glass. Cars collide with glass.
struct Glass {
  double share = 0.0;
  double patch = 0.6;  ///< m
  std::uint64_t seed = 1;
};

/// What ends a ray. Lidar rays pass through unknown cells and leave the grid, as the localizer's do
/// by default (`unknown_is: free`). Unknown space is not drivable.
enum class Ends {
  kAtWalls,
  kWhereNotFree,  ///< at a wall, an unknown cell or the grid's edge
};

/// The end of a ray.
struct Hit {
  double range = 0.0;  ///< m from the origin; +infinity without a hit
  bool on_wall = false;
};

/// The walls. Rays are cast by exact grid traversal in double precision (Amanatides and Woo, 1987),
/// independent of the localizer's casters, so that agreement with them is meaningful.
class World {
 public:
  /// Cells of at least OccupancyGrid::kObstacleFrom are walls; outside the grid is unknown.
  explicit World(const OccupancyGrid& grid);

  const GridGeometry& geometry() const { return geometry_; }

  /// Distance from `origin` to the first cell that ends a ray in direction `yaw` (rad, map frame):
  /// 0 inside such a cell, +infinity if there is none within `max_range`.
  double castWalls(const Eigen::Vector2d& origin, double yaw, double max_range,
                   Ends ends = Ends::kAtWalls) const;

  /// The nearest hit of walls and of obstacles at `time` (s).
  Hit cast(const Eigen::Vector2d& origin, double yaw, double max_range,
           const std::vector<Obstacle>& obstacles, double time, Ends ends = Ends::kAtWalls) const;

  bool isWall(const Eigen::Vector2d& point) const;

  /// Known to be free: not a wall, unknown or outside.
  bool isFree(const Eigen::Vector2d& point) const;

  /// Area of known free space, m^2.
  double freeArea() const;

  /// Whether the wall at `point` is glass.
  static bool isGlass(const Glass& glass, const Eigen::Vector2d& point);

  /// A uniformly random point of known free space. Throws MapError if there is none.
  Eigen::Vector2d randomFreePoint(Random& random) const;

 private:
  GridGeometry geometry_;
  std::vector<std::uint8_t> cells_;  ///< free, unknown or wall; row-major, lowest row first
  std::vector<std::uint32_t> free_;  ///< indices of the free cells, increasing
};

/// The path of a map's world: `<map>_world.yaml` if it exists, else the map itself.
std::string worldPathFor(const std::string& map_yaml_path);

/// The pose in `<map>_start.yaml` (`start: [x, y, yaw]`, m and rad in the map frame). Returns false
/// if there is no such file; throws MapError if it is invalid.
bool loadStartPose(const std::string& map_yaml_path, Pose2& start_in_map);

/// As loadStartPose; throws MapError if there is no such file.
Pose2 requireStartPose(const std::string& map_yaml_path);

}  // namespace racecar_mcl::sim
