// Pose patterns for benchmarks of casters and filters.
#pragma once

#include <cstdint>
#include <vector>

#include "racecar_mcl/map/occupancy_grid.h"
#include "racecar_mcl/raycasting/range_caster.h"

namespace racecar_mcl::bench {

/// Poses as arrays.
struct Poses {
  std::vector<double> x, y, yaw;

  PoseBatch batch() const {
    return {x.data(), y.data(), yaw.data(), static_cast<Eigen::Index>(x.size())};
  }
  void add(const Pose2& pose);
};

/// Uniform in free space and yaw.
Poses scatteredPoses(const OccupancyGrid& grid, int count, std::uint64_t seed);

/// Gaussian around a pose; sigma in m and rad.
Poses cloud(const Pose2& centre, int count, double sigma, double sigma_yaw, std::uint64_t seed);

/// A pose with 0.5 m of free space around it.
Pose2 roomyPose(const OccupancyGrid& grid, std::uint64_t seed);

/// The lidar's pose at each scan of a drive along the corridors of basementMap: `seconds` at 40 Hz
/// and 3 m/s.
std::vector<Pose2> basementDrive(const OccupancyGrid& basement, double seconds);

}  // namespace racecar_mcl::bench
