// The map with a ring of one cell around it, so that rays need no bounds check.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

/// A pose in the grid: position in padded cells (the map's corner is (1, 1)), yaw from the
/// grid's x axis.
struct PoseInCells {
  Eigen::Vector2d position{0.0, 0.0};
  double cos_yaw = 1.0;
  double sin_yaw = 0.0;
};

/// A ray that starts inside the map: origin in padded cells, unit direction in the grid.
struct RayInCells {
  double x = 0.0;
  double y = 0.0;
  double dx = 1.0;
  double dy = 0.0;
};

enum CellKind : std::uint8_t {
  kPass = 0,      ///< rays pass
  kObstacle = 1,  ///< rays end
  kOutside = 2    ///< the ring, if the outside is free: rays leave the map
};

/// The kinds of all padded cells, row by row, the ring included.
std::vector<std::uint8_t> cellKinds(const OccupancyGrid& grid, UnknownIs unknown_is);

/// Geometry of the padded cells.
class PaddedGrid {
 public:
  PaddedGrid(const GridGeometry& geometry, UnknownIs unknown_is);

  int width() const { return geometry_.width + 2; }
  int height() const { return geometry_.height + 2; }
  double resolution() const { return geometry_.resolution; }
  bool outsideIsFree() const { return outside_is_free_; }

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(column);
  }

  /// The position of a pose in padded cells.
  Eigen::Vector2d position(const Pose2& in_map) const;
  PoseInCells toCells(const Pose2& in_map) const;

  /// Whether a position is inside the map, the ring excluded. False for NaN.
  bool contains(const Eigen::Vector2d& position) const {
    return position.x() >= 1.0 && position.y() >= 1.0 && position.x() < geometry_.width + 1.0 &&
           position.y() < geometry_.height + 1.0;
  }

  /// Moves the origin of a ray from outside the map to the point where it enters the map. Returns
  /// the distance moved in cells, or infinity if the ray misses the map.
  double enter(RayInCells& ray) const;

 private:
  GridGeometry geometry_;
  bool outside_is_free_;
  double cos_origin_;
  double sin_origin_;
};

}  // namespace racecar_mcl
