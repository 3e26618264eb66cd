#include "range_casters/distance_transform_caster.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/distance_field.h"
#include "range_casters/cast_each.h"

namespace racecar_mcl {
namespace {

constexpr float kHit = -1.0F;
constexpr float kMiss = -2.0F;

/// How far beyond a border, in cells, the walk looks for the next cell: enough to be surely across.
constexpr double kAcross = 1e-9;

/// One axis of the walk.
struct Axis {
  Axis(double origin_in, double direction_in)
      : origin(origin_in),
        direction(std::abs(direction_in) < 1e-12 ? 1e-12 : direction_in),
        inverse(1.0 / direction),
        to_exit(direction > 0.0 ? 1.0 + kAcross : -kAcross),
        to_entry(direction > 0.0 ? 0.0 : 1.0) {}

  int cellAt(double distance) const { return static_cast<int>(origin + distance * direction); }
  double exit(int cell) const { return (cell + to_exit - origin) * inverse; }
  double entry(int cell) const { return (cell + to_entry - origin) * inverse; }

  double origin;
  double direction;
  double inverse;
  double to_exit;   ///< from the cell's lower border to just across the one the ray leaves by
  double to_entry;  ///< from the cell's lower border to the one the ray comes in by
};

std::vector<float> buildField(const PaddedGrid& grid, const std::vector<std::uint8_t>& kinds) {
  std::vector<std::uint8_t> ends(kinds.size());
  std::transform(kinds.begin(), kinds.end(), ends.begin(),
                 [](std::uint8_t kind) { return kind != kPass; });
  std::vector<float> field = clearances(ends, grid.width(), grid.height());
  std::transform(field.begin(), field.end(), kinds.begin(), field.begin(),
                 [](float clearance, std::uint8_t kind) {
                   if (kind == kObstacle) return kHit;
                   if (kind == kOutside) return kMiss;
                   return std::nextafter(clearance, 0.0F);  // its root may have been rounded up
                 });
  return field;
}

}  // namespace

DistanceTransformCaster::DistanceTransformCaster(const OccupancyGrid& grid,
                                                 const RangeCasterParameters& parameters)
    : grid_(grid.geometry(), parameters.unknown_is),
      max_range_(parameters.max_range),
      field_(buildField(grid_, cellKinds(grid, parameters.unknown_is))) {}

double DistanceTransformCaster::walk(const RayInCells& ray, double limit) const {
  const Axis column(ray.x, ray.dx);
  const Axis row(ray.y, ray.dy);
  for (double distance = 0.0; distance < limit;) {
    const int x = column.cellAt(distance);
    const int y = row.cellAt(distance);
    const float clearance = field_[grid_.index(x, y)];
    if (clearance == kMiss) return limit;
    if (clearance == kHit) {
      // Negative where the ray starts in an obstacle.
      return std::clamp(std::max(column.entry(x), row.entry(y)), 0.0, limit);
    }
    distance = std::min(column.exit(x), row.exit(y)) + static_cast<double>(clearance);
  }
  return limit;
}

void DistanceTransformCaster::cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                                   Eigen::Ref<Eigen::ArrayXXf> ranges) const {
  castEach(grid_, max_range_, lidar_in_map, bearings, ranges,
           [&](const RayInCells& ray, double limit) { return walk(ray, limit); });
}

std::size_t DistanceTransformCaster::memoryBytes() const {
  return sizeof(*this) + field_.size() * sizeof(float);
}

}  // namespace racecar_mcl
