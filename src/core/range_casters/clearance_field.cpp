#include "range_casters/clearance_field.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/distance_field.h"

namespace racecar_mcl {
namespace {

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

}  // namespace

ClearanceField::ClearanceField(const OccupancyGrid& grid, UnknownIs unknown_is)
    : cells_(cellKinds(grid, unknown_is)) {
  std::vector<std::uint8_t> ends(cells_.size());
  std::transform(cells_.begin(), cells_.end(), ends.begin(),
                 [](std::uint8_t kind) { return kind != kPass; });
  const std::vector<float> field =
      clearances(ends, grid.geometry().width + 2, grid.geometry().height + 2);
  std::transform(field.begin(), field.end(), cells_.begin(), cells_.begin(),
                 [](float clearance, std::uint8_t kind) {
                   return kind == kObstacle  ? kHit
                          : kind == kOutside ? kMiss
                                             : static_cast<std::uint8_t>(std::min(
                                                   clearance, static_cast<float>(kLongest)));
                 });
}

double walk(const PaddedGrid& grid, const ClearanceField& field, const RayInCells& ray,
            double limit) {
  const Axis column(ray.x, ray.dx);
  const Axis row(ray.y, ray.dy);
  for (double distance = 0.0; distance < limit;) {
    const int x = column.cellAt(distance);
    const int y = row.cellAt(distance);
    const std::uint8_t clearance = field.data()[grid.index(x, y)];
    if (clearance == ClearanceField::kMiss) return limit;
    if (clearance == ClearanceField::kHit) {
      // Negative where the ray starts in an obstacle.
      return std::clamp(std::max(column.entry(x), row.entry(y)), 0.0, limit);
    }
    distance = std::min(column.exit(x), row.exit(y)) + clearance;
  }
  return limit;
}

}  // namespace racecar_mcl
