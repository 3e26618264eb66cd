// Simulated drives among obstacles that the map lacks, with an ObstacleEvaluation.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "offline/fault_injection.h"
#include "offline/obstacle_evaluation.h"
#include "offline/wrong_course.h"

namespace racecar_mcl {

struct ObstacleDrive {
  std::string map;                 ///< path of the YAML; the drive starts at the map's start pose
  std::string map_fault = "none";  ///< of the localizer's map, see sim::mapFaults
  double wall_displacement = 0.0;  ///< m, of the map's walls at most, alternating every 1.6 m
  Fault traffic = Fault::kNone;    ///< kObstacles, kCrowd or kOpponent
  bool has_car_ahead = false;      ///< a car that drives 0.6 s ahead on the same path, instead
  double range_noise = 0.01;       ///< m, standard deviation
  double speed = 3.0;              ///< m/s
  double seconds = 20.0;
  std::uint64_t seed = 1;
  ObstacleDetectionParameters detection;
};

constexpr double kCarAheadLead = 0.6;  // s

/// The true poses of a drive without obstacles, one per control step.
inline std::vector<Pose2> recordTruth(const ObstacleDrive& settings, const Course& course,
                                      const Pose2& start) {
  SimulatedDrive drive(course, {}, {}, start, settings.speed, settings.seed);
  std::vector<Pose2> poses;
  drive.before_control_step = [&](sim::Simulator* simulator) {
    poses.push_back(simulator->truth().base_in_map);
  };
  drive.drive(settings.seconds + kCarAheadLead + 1.0, [](const Observation&) {});
  return poses;
}

/// The outline of a car.
inline sim::Obstacle carAt(const Pose2& base_in_map) {
  const sim::CarParameters car;
  sim::Obstacle box;
  box.shape = sim::Obstacle::Shape::kBox;
  box.length = car.length_ahead + car.length_behind;
  box.width = car.width;
  box.in_map = compose(base_in_map, {(car.length_ahead - car.length_behind) / 2.0, 0.0, 0.0});
  box.keeps_clear = true;
  return box;
}

/// Throws as loadWrongCourse.
inline ObstacleScore driveOnce(const ObstacleDrive& settings) {
  const LocalizerParameters parameters;
  Random random(settings.seed);
  auto [course, start, wrong] =
      loadWrongCourse(settings.map, settings.map_fault, parameters, random);
  if (settings.wall_displacement > 0.0) {
    constexpr double kWave = 2.0;  // rad/m
    wrong.map = sim::distort(wrong.map, settings.wall_displacement,
                             kWave * settings.wall_displacement, random);
  }
  course.map = makeLocalizationMap(std::move(wrong.map), parameters);
  sim::SimulatorParameters simulator;
  simulator.lidar.range_noise = settings.range_noise;
  SimulatedDrive drive(course, parameters, simulator, start, settings.speed, settings.seed);
  drive.localizer().initialize(startAt(start));
  if (settings.has_car_ahead) {
    const auto lead = static_cast<std::size_t>(std::lround(kCarAheadLead / sim::kControlPeriod));
    drive.before_control_step = [poses = recordTruth(settings, course, start),
                                 step = lead](sim::Simulator* car) mutable {
      car->setObstacles({carAt(poses[std::min(step++, poses.size() - 1)])});
    };
  } else {
    placeObstacles(settings.traffic, course, wrong.boxes, settings.seed, random, &drive);
  }
  ObstacleEvaluation evaluation(course.world, settings.detection, &drive);
  drive.drive(settings.seconds, [&](const Observation& seen) { evaluation.add(seen); });
  return evaluation.score();
}

}  // namespace racecar_mcl
