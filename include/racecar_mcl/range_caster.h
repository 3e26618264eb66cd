// The interface every ray caster stands behind. A caster knows a map and no probability.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "racecar_mcl/occupancy_grid.h"
#include "racecar_mcl/pose.h"

namespace racecar_mcl {

/// A view of N lidar poses in the map frame, one array per component (m, m, rad). It owns nothing.
struct PoseBatch {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* yaw = nullptr;
  Eigen::Index size = 0;

  Pose2 pose(Eigen::Index i) const { return {x[i], y[i], yaw[i]}; }

  PoseBatch segment(Eigen::Index first, Eigen::Index count) const {
    return {x + first, y + first, yaw + first, count};
  }
};

struct RangeCasterParameters {
  std::string range_method = "simd";        ///< which caster, by name
  double max_range = 10.0;                  ///< m, no range is longer than this
  UnknownIs unknown_is = UnknownIs::kFree;  ///< also what the outside of the map is taken for

  // Of the method that remembers, `panorama`. Finer is more exact, costs more rays and remembers
  // less far; half a map cell and 0.35 degrees keep 95 % of the ranges within one cell.
  double panorama_spacing = 0.025;  ///< m between remembered places, at most a map cell
  int panorama_directions = 1024;   ///< in a full turn, 16 to 16384; made a multiple of 16
  double panorama_memory = 60.0;    ///< MB, 0 to 10000; at most that
};

/// Casts rays from many poses at many bearings.
///
/// A range is the distance from the pose to the point where the ray enters the first obstacle cell,
/// at most `max_range`. It is 0 from inside an obstacle, and `max_range` where the ray meets none.
/// The outside of the map is unknown: with unknown_is free a ray passes through it, into the map
/// again if it points there; with unknown_is occupied it ends there. A pose or bearing that is not
/// finite gives `max_range`.
class RangeCaster {
 public:
  virtual ~RangeCaster() = default;

  /// Told once per update of all poses that the following `cast` calls may ask for; bearings are in
  /// rad. A caster that remembers builds what is missing here. Not to be called while another
  /// thread casts.
  virtual void prepare(const PoseBatch& /*lidar_in_map*/, const Eigen::ArrayXf& /*bearings*/) {}

  /// `ranges(k, i)`, m, for bearing k (rad, counter-clockwise from the pose's yaw) of pose i;
  /// `ranges` is already bearings.size() x poses.size, else std::invalid_argument is thrown. Safe
  /// to call from several threads.
  virtual void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                    Eigen::Ref<Eigen::ArrayXXf> ranges) const = 0;

  /// Memory held for casting, bytes.
  virtual std::size_t memoryBytes() const = 0;
};

/// The names `makeRangeCaster` knows.
std::vector<std::string> rangeCasterNames();

/// Throws ParameterError on an unknown method and on a value out of range.
void validate(const RangeCasterParameters& parameters);

/// Throws as `validate`.
std::unique_ptr<RangeCaster> makeRangeCaster(const OccupancyGrid& grid,
                                             const RangeCasterParameters& parameters);

}  // namespace racecar_mcl
