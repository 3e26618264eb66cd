#include "seen_beams.h"

#include <algorithm>
#include <limits>

#include "racecar_mcl/map_model.h"

namespace racecar_mcl {

SeenBeams seeBeams(MapModel* map, const Pose2& base_in_map, const Scan& beams) {
  const Pose2 lidar = compose(base_in_map, beams.laser_in_base);
  const PoseBatch pose{&lidar.x, &lidar.y, &lidar.yaw, 1};
  Eigen::ArrayXXf ranges(beams.size(), 1);
  map->caster->prepare(pose, beams.bearings);
  map->caster->cast(pose, beams.bearings, ranges);
  // A ray cast to its full range meets nothing.
  const Eigen::ArrayXf walls = (ranges.col(0) < map->max_range)
                                   .select(ranges.col(0), std::numeric_limits<float>::quiet_NaN());
  return {map->search.field().beamLogLikelihoods(lidar, beams), walls};
}

float logLikelihoodNearSurface(const MapModel& map, double distance) {
  const double near = std::max(distance, map.grid.geometry().resolution);
  return static_cast<float>(map.search.field().logLikelihoodAt(near));
}

}  // namespace racecar_mcl
