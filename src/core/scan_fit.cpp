#include "racecar_mcl/scan_fit.h"

#include <algorithm>
#include <cmath>

#include "racecar_mcl/particle_filter.h"

namespace racecar_mcl {
namespace {

// A lidar that sees nothing farther away is covered.
constexpr float kClose = 0.3f;    // m
constexpr double kNear = 0.2;     // m
constexpr float kThrough = 0.5f;  // m

}  // namespace

ScanFit fitScan(MapModel* map, const Pose2& base_in_map, const Scan& beams) {
  const Pose2 lidar = compose(base_in_map, beams.laser_in_base);
  const LikelihoodField& field = map->search.field();
  const Eigen::ArrayXf log_likelihoods = field.beamLogLikelihoods(lidar, beams);
  // A surface lies anywhere in its cell, and the field is measured from the cell's centre.
  const double near = std::max(kNear, map->grid.geometry().resolution);
  const auto least = static_cast<float>(field.logLikelihoodAt(near));

  const PoseBatch pose{&lidar.x, &lidar.y, &lidar.yaw, 1};
  Eigen::ArrayXXf expected(beams.size(), 1);
  map->caster->prepare(pose, beams.bearings);
  map->caster->cast(pose, beams.bearings, expected);

  ScanFit fit;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (std::isnan(log_likelihoods[k]) || beams.ranges[k] < kClose) continue;
    ++fit.beams;
    // A ray cast to its full range meets nothing; a measured range beyond that proves nothing.
    const bool through =
        expected(k, 0) < map->max_range && beams.ranges[k] > expected(k, 0) + kThrough;
    const bool at_surface = log_likelihoods[k] >= least;
    fit.explained += at_surface && !through ? 1.0 : 0.0;
  }
  if (fit.beams > 0) fit.explained /= fit.beams;
  return fit;
}

}  // namespace racecar_mcl
