#include "raycasting/padded_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace racecar_mcl {

std::vector<std::uint8_t> cellKinds(const OccupancyGrid& grid, UnknownIs unknown_is) {
  const std::vector<std::uint8_t> mask = obstacleMask(grid, unknown_is);
  const std::ptrdiff_t width = grid.geometry().width;
  const std::ptrdiff_t height = grid.geometry().height;
  std::vector<std::uint8_t> kinds(static_cast<std::size_t>((width + 2) * (height + 2)),
                                  unknown_is == UnknownIs::kFree ? kOutside : kObstacle);
  for (std::ptrdiff_t row = 0; row < height; ++row) {
    const auto first = mask.begin() + row * width;
    std::transform(first, first + width, kinds.begin() + (row + 1) * (width + 2) + 1,
                   [](std::uint8_t ends) { return ends != 0 ? kObstacle : kPass; });
  }
  return kinds;
}

PaddedGrid::PaddedGrid(const GridGeometry& geometry, UnknownIs unknown_is)
    : geometry_(geometry),
      outside_is_free_(unknown_is == UnknownIs::kFree),
      cos_origin_(std::cos(geometry.origin.yaw)),
      sin_origin_(std::sin(geometry.origin.yaw)) {}

Eigen::Vector2d PaddedGrid::position(const Pose2& in_map) const {
  const double dx = (in_map.x - geometry_.origin.x) / geometry_.resolution;
  const double dy = (in_map.y - geometry_.origin.y) / geometry_.resolution;
  return {1.0 + cos_origin_ * dx + sin_origin_ * dy, 1.0 - sin_origin_ * dx + cos_origin_ * dy};
}

PoseInCells PaddedGrid::toCells(const Pose2& in_map) const {
  const double c = std::cos(in_map.yaw);
  const double s = std::sin(in_map.yaw);
  return {position(in_map), c * cos_origin_ + s * sin_origin_, s * cos_origin_ - c * sin_origin_};
}

double PaddedGrid::enter(RayInCells& ray) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double first = 0.0;  // interval of the ray inside both slabs
  double last = kInfinity;
  const auto clip = [&](double origin, double direction, double size) {
    if (direction == 0.0) {
      if (!(origin >= 1.0 && origin < size + 1.0)) last = -kInfinity;
      return;
    }
    const double a = (1.0 - origin) / direction;
    const double b = (size + 1.0 - origin) / direction;
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  };
  clip(ray.x, ray.dx, geometry_.width);
  clip(ray.y, ray.dy, geometry_.height);
  if (!(first < last) || !std::isfinite(first)) return kInfinity;

  const auto inside = [](double value, double size) {
    return std::clamp(value, 1.0, std::nextafter(size + 1.0, 0.0));
  };
  ray.x = inside(ray.x + first * ray.dx, geometry_.width);
  ray.y = inside(ray.y + first * ray.dy, geometry_.height);
  return first;
}

}  // namespace racecar_mcl
