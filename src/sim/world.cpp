#include "sim/world.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>

#include "racecar_mcl/common/errors.h"
#include "sim/infinity.h"

namespace racecar_mcl::sim {
namespace {

// Cell kinds, in the order used by castWalls.
constexpr std::uint8_t kFree = 0;
constexpr std::uint8_t kUnknown = 1;
constexpr std::uint8_t kWall = 2;

std::uint8_t kindOf(std::int8_t value) {
  if (value < 0) return kUnknown;
  return value >= OccupancyGrid::kObstacleFrom ? kWall : kFree;
}

std::string besideMap(const std::string& map_yaml_path, const std::string& suffix) {
  const std::size_t slash = map_yaml_path.find_last_of('/');
  const std::size_t dot = map_yaml_path.find_last_of('.');
  const bool has_extension =
      dot != std::string::npos && (slash == std::string::npos || dot > slash);
  return map_yaml_path.substr(0, has_extension ? dot : std::string::npos) + suffix;
}

/// One axis of the traversal: the current cell, and the distance to the next one.
struct Axis {
  double start;
  double direction;
  int size;
  int cell;
  int step;

  Axis(double start_, double direction_, int size_, double enter)
      : start(start_), direction(direction_), size(size_), step(direction_ > 0.0 ? 1 : -1) {
    // Rays that enter from outside may be rounded to either side of the edge.
    cell = std::clamp(static_cast<int>(std::floor(start + enter * direction)), 0, size - 1);
  }

  bool inside() const { return cell >= 0 && cell < size; }

  /// Computed from the cell index, so that rounding errors do not accumulate.
  double next() const {
    if (direction == 0.0) return kInfinity;
    return (cell + (step > 0 ? 1 : 0) - start) / direction;
  }
};

}  // namespace

World::World(const OccupancyGrid& grid) : geometry_(grid.geometry()), cells_(grid.cells().size()) {
  std::transform(grid.cells().begin(), grid.cells().end(), cells_.begin(), kindOf);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i] == kFree) free_.push_back(static_cast<std::uint32_t>(i));
  }
}

double World::castWalls(const Eigen::Vector2d& origin, double yaw, double max_range,
                        Ends ends) const {
  const Eigen::Vector2d start = worldToGrid(geometry_, origin);
  const double angle = yaw - geometry_.origin.yaw;
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d size(geometry_.width, geometry_.height);
  if (!start.allFinite() || !direction.allFinite()) return kInfinity;
  const std::uint8_t ends_at = ends == Ends::kAtWalls ? kWall : kUnknown;
  const bool inside = (start.array() >= 0.0).all() && (start.array() < size.array()).all();
  if (ends == Ends::kWhereNotFree && !inside) return 0.0;

  // The part of the ray inside the grid, in cells.
  double enter = 0.0;
  double exit = kInfinity;
  for (int axis = 0; axis < 2; ++axis) {
    if (direction[axis] == 0.0) {
      if (start[axis] < 0.0 || start[axis] >= size[axis]) return kInfinity;
      continue;
    }
    const double a = -start[axis] / direction[axis];
    const double b = (size[axis] - start[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  const double longest = max_range / geometry_.resolution;
  const double leave = std::min(longest, exit);
  if (enter > leave) return kInfinity;

  Axis column(start.x(), direction.x(), geometry_.width, enter);
  Axis row(start.y(), direction.y(), geometry_.height, enter);
  double distance = enter;
  double next_column = column.next();
  double next_row = row.next();
  const CellIndex index(geometry_);
  while (distance <= leave && column.inside() && row.inside()) {
    if (cells_[index({column.cell, row.cell})] >= ends_at) return distance * geometry_.resolution;
    if (next_column < next_row) {
      distance = next_column;
      column.cell += column.step;
      next_column = column.next();
    } else {
      distance = next_row;
      row.cell += row.step;
      next_row = row.next();
    }
  }
  const bool reaches_edge = ends == Ends::kWhereNotFree && exit <= longest;
  return reaches_edge ? exit * geometry_.resolution : kInfinity;
}

Hit World::cast(const Eigen::Vector2d& origin, double yaw, double max_range,
                const std::vector<Obstacle>& obstacles, double time, Ends ends) const {
  const Eigen::Vector2d direction(std::cos(yaw), std::sin(yaw));
  Hit hit{kInfinity, false};
  for (const Obstacle& obstacle : obstacles) {
    const double range = castObstacle(obstacle, poseAt(obstacle, time), origin, direction);
    if (range <= max_range) hit.range = std::min(hit.range, range);
  }
  const double walls = castWalls(origin, yaw, std::min(max_range, hit.range), ends);
  return walls <= hit.range ? Hit{walls, std::isfinite(walls)} : hit;
}

bool World::isWall(const Eigen::Vector2d& point) const {
  const Cell cell = cellAt(geometry_, point);
  return contains(geometry_, cell) && cells_[CellIndex(geometry_)(cell)] == kWall;
}

bool World::isFree(const Eigen::Vector2d& point) const {
  const Cell cell = cellAt(geometry_, point);
  return contains(geometry_, cell) && cells_[CellIndex(geometry_)(cell)] == kFree;
}

double World::freeArea() const {
  return static_cast<double>(free_.size()) * geometry_.resolution * geometry_.resolution;
}

bool World::isGlass(const Glass& glass, const Eigen::Vector2d& point) {
  if (glass.share <= 0.0) return false;
  const auto column = static_cast<std::int64_t>(std::floor(point.x() / glass.patch));
  const auto row = static_cast<std::int64_t>(std::floor(point.y() / glass.patch));
  Random patch(glass.seed + 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(column) +
               0xc2b2ae3d27d4eb4fULL * static_cast<std::uint64_t>(row));
  return patch.uniform() < glass.share;
}

Eigen::Vector2d World::randomFreePoint(Random& random) const {
  if (free_.empty()) throw MapError("the world has no free cell; expected at least one");
  const std::uint32_t index = free_[random.index(free_.size())];
  const auto width = static_cast<std::uint32_t>(geometry_.width);
  const std::uint32_t column = index % width;
  const std::uint32_t row = index / width;
  const double x = column + random.uniform();
  const double y = row + random.uniform();
  return gridToWorld(geometry_, {x, y});
}

std::string worldPathFor(const std::string& map_yaml_path) {
  const std::string world = besideMap(map_yaml_path, "_world.yaml");
  return std::ifstream(world).good() ? world : map_yaml_path;
}

bool loadStartPose(const std::string& map_yaml_path, Pose2& start_in_map) {
  const std::string path = besideMap(map_yaml_path, "_start.yaml");
  if (!std::ifstream(path).good()) return false;
  try {
    const auto start = YAML::LoadFile(path)["start"].as<std::vector<double>>();
    if (start.size() == 3 && isFinite(Pose2{start[0], start[1], start[2]})) {
      start_in_map = {start[0], start[1], wrapAngle(start[2])};
      return true;
    }
  } catch (const YAML::Exception& error) {
    throw MapError(path + ": " + error.what() + "; expected `start: [x, y, yaw]`");
  }
  throw MapError(path + ": expected `start: [x, y, yaw]` with three finite numbers (m, m, rad)");
}

Pose2 requireStartPose(const std::string& map_yaml_path) {
  Pose2 start;
  if (loadStartPose(map_yaml_path, start)) return start;
  throw MapError(map_yaml_path +
                 ": the map has no start pose; expected a file *_start.yaml beside it");
}

}  // namespace racecar_mcl::sim
