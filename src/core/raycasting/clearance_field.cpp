#include "raycasting/clearance_field.h"

#include <algorithm>
#include <cmath>

#include "map/distance_transform.h"

namespace racecar_mcl {
namespace {

// Distance past a border, in cells, at which the next cell is looked up: above the rounding error.
constexpr double kBorderMargin = 1e-9;
// Minimum magnitude of a direction's component, so that its inverse is finite.
constexpr double kMinDirection = 1e-12;

/// The cell borders that a ray crosses along one axis.
struct Borders {
  Borders(double origin_in, double direction_in)
      : origin(origin_in),
        direction(std::abs(direction_in) < kMinDirection ? kMinDirection : direction_in),
        inverse(1.0 / direction),
        to_exit(direction > 0.0 ? 1.0 + kBorderMargin : -kBorderMargin),
        to_entry(direction > 0.0 ? 0.0 : 1.0) {}

  int cellAt(double distance) const { return static_cast<int>(origin + distance * direction); }
  double exit(int cell) const { return (cell + to_exit - origin) * inverse; }
  double entry(int cell) const { return (cell + to_entry - origin) * inverse; }

  double origin;
  double direction;
  double inverse;
  double to_exit;   ///< from the cell's lower border to just past the border where the ray leaves
  double to_entry;  ///< from the cell's lower border to the border where the ray enters
};

}  // namespace

ClearanceField::ClearanceField(const OccupancyGrid& grid, UnknownIs unknown_is)
    : cells_(cellKinds(grid, unknown_is)) {
  const int width = grid.geometry().width + 2;
  const int height = grid.geometry().height + 2;
  // Clearances are distances to the dilated obstacles (distance_field.h); the kind of passable
  // cells is 0.
  const DistanceTransform distances(dilated(cells_, width, height, 1), width, height,
                                    kMaxClearance);
  distances.forEachRow([&](const DistanceTransform::Row& row) {
    for (int column = 0; column < width; ++column) {
      std::uint8_t& cell = cells_[row.first + static_cast<std::size_t>(column)];
      const float clearance = std::min(row.distance(column), static_cast<float>(kMaxClearance));
      cell = cell == kObstacle  ? kHit
             : cell == kOutside ? kMiss
                                : static_cast<std::uint8_t>(clearance);
    }
  });
}

double marchRay(const PaddedGrid& grid, const ClearanceField& field, const RayInCells& ray,
                double limit) {
  const Borders column(ray.x, ray.dx);
  const Borders row(ray.y, ray.dy);
  for (double distance = 0.0; distance < limit;) {
    const int x = column.cellAt(distance);
    const int y = row.cellAt(distance);
    const std::uint8_t clearance = field.data()[grid.index(x, y)];
    if (clearance == ClearanceField::kMiss) return limit;
    if (clearance == ClearanceField::kHit) {
      // Negative if the ray starts inside an obstacle.
      return std::clamp(std::max(column.entry(x), row.entry(y)), 0.0, limit);
    }
    distance = std::min(column.exit(x), row.exit(y)) + clearance;
  }
  return limit;
}

}  // namespace racecar_mcl
