#include "seen_beams.h"

#include <algorithm>
#include <limits>

#include "racecar_mcl/map_model.h"

namespace racecar_mcl {

void seeBeams(MapModel* map, const Pose2& base_in_map, const Scan& beams, SeenBeams* seen) {
  const Pose2 lidar = compose(base_in_map, beams.laser_in_base);
  const PoseBatch pose{&lidar.x, &lidar.y, &lidar.yaw, 1};
  seen->walls.resize(beams.size(), 1);
  map->caster->prepare(pose, beams.bearings);
  map->caster->cast(pose, beams.bearings, seen->walls);
  // A ray cast to its full range meets nothing.
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (!(seen->walls(k) < map->max_range)) {
      seen->walls(k) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  seen->log_likelihoods.resize(beams.size());
  map->search.field().beamLogLikelihoods(lidar, beams, seen->log_likelihoods);
}

float logLikelihoodNearSurface(const MapModel& map, double distance) {
  const double near = std::max(distance, map.grid.geometry().resolution);
  return static_cast<float>(map.search.field().logLikelihoodAt(near));
}

}  // namespace racecar_mcl
