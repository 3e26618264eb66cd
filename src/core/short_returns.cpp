#include "racecar_mcl/short_returns.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace racecar_mcl {
namespace {

constexpr float kBefore = 0.5f;          // m
constexpr double kAtSurface = 0.15;      // m
constexpr Eigen::Index kOneStaysOf = 2;  // beams, at least

}  // namespace

Scan withoutShortReturns(MapModel* map, const Pose2& base_in_map, const Scan& beams,
                         Eigen::Index least) {
  const Pose2 lidar = compose(base_in_map, beams.laser_in_base);
  const LikelihoodField& field = map->search.field();
  const Eigen::ArrayXf log_likelihoods = field.beamLogLikelihoods(lidar, beams);
  const double near = std::max(kAtSurface, map->grid.geometry().resolution);
  const auto free = static_cast<float>(field.logLikelihoodAt(near));

  const PoseBatch pose{&lidar.x, &lidar.y, &lidar.yaw, 1};
  Eigen::ArrayXXf expected(beams.size(), 1);
  map->caster->prepare(pose, beams.bearings);
  map->caster->cast(pose, beams.bearings, expected);

  std::vector<Eigen::Index> kept;
  kept.reserve(static_cast<std::size_t>(beams.size()));
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    // A ray cast to its full range meets no wall, and where there is none no beam ends before it.
    const bool stopped = expected(k, 0) < map->max_range &&
                         beams.ranges[k] < expected(k, 0) - kBefore && log_likelihoods[k] < free;
    if (!stopped) kept.push_back(k);
  }
  const auto staying = static_cast<Eigen::Index>(kept.size());
  if (staying < least || kOneStaysOf * staying < beams.size()) return beams;
  return takeBeams(beams, kept);
}

}  // namespace racecar_mcl
