// Interface of the ray casters: expected ranges on a map.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "racecar_mcl/geometry/pose_batch.h"
#include "racecar_mcl/map/occupancy_grid.h"

namespace racecar_mcl {

struct RangeCasterParameters {
  std::string range_method = "simd";        ///< one of rangeCasterNames()
  double max_range = 10.0;                  ///< m, maximum range
  UnknownIs unknown_is = UnknownIs::kFree;  ///< for unknown cells and outside the map

  // Lookup table (`lut`). With half a map cell and 0.35 degrees 95 % of the ranges are within one
  // cell of the exact ones; a finer table costs more rays and covers less area per MB.
  double lut_spacing = 0.025;  ///< m between positions, at most a map cell
  int lut_directions = 1024;   ///< per full turn, 16 to 16384; rounded up to a multiple of 16
  double lut_memory = 60.0;    ///< MB, maximum, 0 to 10000
};

/// Casts rays from many poses at many bearings.
///
/// A range is the distance from the pose to the point where the ray enters the first obstacle cell,
/// at most `max_range`. It is 0 inside an obstacle, and `max_range` if the ray hits none. The
/// outside of the map is unknown: with UnknownIs::kFree a ray passes through it and may enter the
/// map again; with kOccupied it ends there. The range of a pose or bearing that is not finite is
/// `max_range`.
class RangeCaster {
 public:
  explicit RangeCaster(double max_range) : max_range_(max_range) {}
  virtual ~RangeCaster() = default;

  /// Maximum range, m.
  double maxRange() const { return max_range_; }

  /// Announces the poses and bearings (rad) of the following `cast` calls, so that
  /// a caster with a cache can fill it. Not thread-safe, also against `cast`.
  virtual void prepare(const PoseBatch& /*lidar_in_map*/, const Eigen::ArrayXf& /*bearings*/) {}

  /// Writes `ranges(k, i)`, m, for bearing k (rad, counter-clockwise from the pose's yaw) of pose
  /// i. Throws std::invalid_argument if `ranges` is not bearings.size() x lidar_in_map.size.
  /// Thread-safe.
  virtual void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
                    Eigen::Ref<Eigen::ArrayXXf> ranges) const = 0;

  /// Memory used for casting, bytes.
  virtual std::size_t memoryBytes() const = 0;

 private:
  double max_range_;
};

/// The values of range_method.
std::vector<std::string> rangeCasterNames();

/// Throws ParameterError on an unknown method and on a value out of range.
void validate(const RangeCasterParameters& parameters);

/// Throws as `validate`.
std::unique_ptr<RangeCaster> makeRangeCaster(const OccupancyGrid& grid,
                                             const RangeCasterParameters& parameters);

}  // namespace racecar_mcl
