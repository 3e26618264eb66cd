// A course whose map the localizer gets with a fault.
#pragma once

#include <string>
#include <utility>

#include "offline/simulated_drive.h"
#include "sim/map_faults.h"

namespace racecar_mcl {

struct WrongCourse {
  Course course;  ///< with the right map
  Pose2 start;    ///< the map's start pose
  sim::WrongMap wrong;
};

/// `map_fault`: see sim::mapFaults. Throws as loadCourse, requireStartPose and makeWrongMap.
inline WrongCourse loadWrongCourse(const std::string& map_path, const std::string& map_fault,
                                   const LocalizerParameters& parameters, Random& random) {
  Course course = loadCourse(map_path, parameters);
  const Pose2 start = sim::requireStartPose(map_path);
  sim::WrongMap wrong = sim::makeWrongMap(sim::mapFaults().at(map_fault), course.map->grid,
                                          *course.world, start, random);
  return {std::move(course), start, std::move(wrong)};
}

}  // namespace racecar_mcl
