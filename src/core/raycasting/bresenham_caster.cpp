#include "raycasting/bresenham_caster.h"

#include <cmath>
#include <limits>

#include "raycasting/cast_each.h"

namespace racecar_mcl {
namespace {

/// One axis of the traversal: distance along the ray of the next cell border.
struct Axis {
  Axis(double origin, double direction, std::ptrdiff_t cells_apart)
      : step(direction > 0.0 ? cells_apart : -cells_apart),
        between_borders(direction != 0.0 ? 1.0 / std::abs(direction)
                                         : std::numeric_limits<double>::infinity()),
        next_border(direction != 0.0
                        ? (std::floor(origin) + (direction > 0.0 ? 1.0 : 0.0) - origin) / direction
                        : std::numeric_limits<double>::infinity()) {}

  std::ptrdiff_t step;
  double between_borders;
  double next_border;
};

double traverse(const std::uint8_t* cell, int width, const RayInCells& ray, double limit) {
  Axis column(ray.x, ray.dx, 1);
  Axis row(ray.y, ray.dy, width);
  double distance = 0.0;
  while (*cell == kPass) {
    Axis& axis = column.next_border < row.next_border ? column : row;
    distance = axis.next_border;
    if (distance >= limit) return limit;
    axis.next_border += axis.between_borders;
    cell += axis.step;
  }
  return *cell == kObstacle ? distance : limit;
}

}  // namespace

BresenhamCaster::BresenhamCaster(const OccupancyGrid& grid, const RangeCasterParameters& parameters)
    : RangeCaster(parameters.max_range),
      grid_(grid.geometry(), parameters.unknown_is),
      kinds_(cellKinds(grid, parameters.unknown_is)) {}

void BresenhamCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                           Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  castEach(grid_, maxRange(), lidar_in_map, bearings, ranges,
           [&](const RayInCells& ray, double limit) {
             return traverse(&kinds_[grid_.index(static_cast<int>(ray.x), static_cast<int>(ray.y))],
                             grid_.width(), ray, limit);
           });
}

std::size_t BresenhamCaster::memoryBytes() const { return sizeof(*this) + kinds_.size(); }

}  // namespace racecar_mcl
