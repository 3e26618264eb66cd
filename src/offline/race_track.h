// A map with a raceline, and the conditions of a race on it.
#pragma once

#include <cstdint>
#include <string>

#include "offline/simulated_drive.h"
#include "racecar_mcl/common/errors.h"
#include "sim/raceline.h"
#include "sim/recorded_drive.h"

namespace racecar_mcl {

/// Grip of the tyres: it limits the speed profile, and wheels that slip falsify the odometry. The
/// simulated car itself does not slide.
struct Grip {
  double limit = 7.0;  ///< m/s^2, see sim::SpeedLimits
  double slip = 0.0;   ///< fraction, see sim::OdometryParameters
};
constexpr Grip kHighGrip{7.0, 0.0};
constexpr Grip kLowGrip{5.0, 0.15};

struct RaceSettings {
  double max_speed = 7.6;  ///< m/s
  Grip grip = kHighGrip;
  bool has_opponent = false;  ///< a car that stays beside or ahead of ours, see sim::Opponent
  int laps = 20;              ///< after the first one, which is from standing and is not evaluated
  std::uint64_t seed = 1;     ///< of sensor noise, particles and opponent
};

constexpr double kRacelineClearance = 0.44;  // m: half the car's width and 0.3 m

/// A map with the path of its raceline.
struct RaceTrack {
  Course course;
  sim::Path path;
};

/// The raceline is that of a wall follower's lap from the map's start pose. Throws MapError without
/// one, and as loadCourse, recordLap and racingPath.
inline RaceTrack loadRaceTrack(const std::string& map_path, const LocalizerParameters& parameters) {
  const Pose2 start = sim::requireStartPose(map_path);
  RaceTrack track{loadCourse(map_path, parameters), {}};
  track.path = sim::racingPath(track.course.map->grid, sim::recordLap(track.course.world, start),
                               kRacelineClearance);
  return track;
}

inline sim::Raceline racelineOf(const RaceTrack& track, const RaceSettings& settings) {
  sim::SpeedLimits limits;
  limits.max_speed = settings.max_speed;
  limits.grip = settings.grip.limit;
  return {track.path, limits};
}

}  // namespace racecar_mcl
