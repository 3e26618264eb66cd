#include "racecar_mcl/map/occupancy_grid.h"

#include <algorithm>
#include <sstream>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

void validate(const GridGeometry& geometry, const std::vector<std::int8_t>& cells) {
  std::ostringstream problem;
  if (geometry.width <= 0 || geometry.height <= 0) {
    problem << "the map is " << geometry.width << " x " << geometry.height
            << " cells; both must be at least 1";
  } else if (!(geometry.resolution >= kMinCellSize && geometry.resolution <= kMaxCellSize)) {
    problem << "the map's resolution is " << geometry.resolution << " m per cell; it must be "
            << "between " << kMinCellSize << " and " << kMaxCellSize;
  } else if (!isWithin(geometry.origin, kMaxCoordinate) ||
             !isWithin(geometry.origin.yaw, kMaxInputAngle)) {
    problem << "the map's origin (" << geometry.origin.x << ", " << geometry.origin.y << ", "
            << geometry.origin.yaw << ") must be finite, with x and y within " << kMaxCoordinate
            << " m and yaw within " << kMaxInputAngle << " rad";
  } else if (cells.size() !=
             static_cast<std::size_t>(geometry.width) * static_cast<std::size_t>(geometry.height)) {
    problem << "the map holds " << cells.size() << " cells; its size " << geometry.width << " x "
            << geometry.height << " needs "
            << static_cast<std::size_t>(geometry.width) * static_cast<std::size_t>(geometry.height);
  } else {
    const auto bad = std::find_if(cells.begin(), cells.end(),
                                  [](std::int8_t value) { return value < -1 || value > 100; });
    if (bad != cells.end()) {
      problem << "cell " << (bad - cells.begin()) << " of the map holds " << static_cast<int>(*bad)
              << "; values run from -1 (unknown) to 100 (occupied)";
    }
  }
  if (!problem.str().empty()) throw MapError(problem.str());
}

}  // namespace

Eigen::Vector2d worldToGrid(const GridGeometry& geometry, const Eigen::Vector2d& point_in_map) {
  const Pose2 in_grid =
      compose(inverse(geometry.origin), Pose2{point_in_map.x(), point_in_map.y(), 0.0});
  return Eigen::Vector2d(in_grid.x, in_grid.y) / geometry.resolution;
}

Eigen::Vector2d gridToWorld(const GridGeometry& geometry, const Eigen::Vector2d& point_in_grid) {
  const Eigen::Vector2d scaled = point_in_grid * geometry.resolution;
  const Pose2 in_map = compose(geometry.origin, Pose2{scaled.x(), scaled.y(), 0.0});
  return {in_map.x, in_map.y};
}

Cell cellAt(const GridGeometry& geometry, const Eigen::Vector2d& point_in_map) {
  // Clamped to just outside the grid, so that far points do not overflow an int. std::max returns
  // its first argument if the second is NaN.
  const Eigen::Vector2d point = worldToGrid(geometry, point_in_map);
  return {static_cast<int>(std::floor(std::min(std::max(-1.0, point.x()), geometry.width + 0.5))),
          static_cast<int>(std::floor(std::min(std::max(-1.0, point.y()), geometry.height + 0.5)))};
}

Eigen::Vector2d cellCentre(const GridGeometry& geometry, const Cell& cell) {
  return gridToWorld(geometry, {cell.column + 0.5, cell.row + 0.5});
}

OccupancyGrid::OccupancyGrid(GridGeometry geometry, std::vector<std::int8_t> cells)
    : geometry_(geometry), cells_(std::move(cells)) {
  validate(geometry_, cells_);
}

std::vector<std::uint8_t> obstacleMask(const OccupancyGrid& grid, UnknownIs unknown_is) {
  const std::uint8_t unknown = unknown_is == UnknownIs::kOccupied ? 1 : 0;
  std::vector<std::uint8_t> mask(grid.cells().size());
  std::transform(grid.cells().begin(), grid.cells().end(), mask.begin(), [&](std::int8_t value) {
    return value < 0 ? unknown : static_cast<std::uint8_t>(value >= OccupancyGrid::kObstacleFrom);
  });
  return mask;
}

bool hasFreeCell(const OccupancyGrid& grid) {
  return std::any_of(grid.cells().begin(), grid.cells().end(), [](std::int8_t value) {
    return value >= 0 && value < OccupancyGrid::kObstacleFrom;
  });
}

bool hasObstacle(const OccupancyGrid& grid) {
  return std::any_of(grid.cells().begin(), grid.cells().end(),
                     [](std::int8_t value) { return value >= OccupancyGrid::kObstacleFrom; });
}

}  // namespace racecar_mcl
