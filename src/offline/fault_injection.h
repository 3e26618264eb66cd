// Faults on simulated drives: kidnapping, pushes, wrong starts, sensor faults, obstacles and
// traffic.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "offline/simulated_drive.h"
#include "sim/random_placement.h"
#include "sim/traffic.h"

namespace racecar_mcl {

constexpr double kStartClearance = 0.3;     // m, around start poses
constexpr double kMinKidnapDistance = 2.0;  // m
constexpr double kCoverRange = 0.05;        // m, of all beams of a covered lidar

enum class Fault {
  kNone,
  kGlobalStart,
  kKidnap,
  kObstacles,
  kCrowd,
  kOpponent,
  kCovered,
  kFrozen,
  kPush,
  kScale,
  kWrongStart
};

/// The names of the faults on the command line.
inline const std::map<std::string, Fault>& faultNames() {
  static const std::map<std::string, Fault> names = {
      {"none", Fault::kNone},
      {"start", Fault::kGlobalStart},
      {"kidnap", Fault::kKidnap},
      {"obstacles", Fault::kObstacles},
      {"push", Fault::kPush},
      {"crowd", Fault::kCrowd},
      {"opponent", Fault::kOpponent},
      {"covered", Fault::kCovered},
      {"frozen_odometry", Fault::kFrozen},
      {"wrong_scale", Fault::kScale},
      {"wrong_start", Fault::kWrongStart},
  };
  return names;
}

/// A random pose at least kMinKidnapDistance away, clear of walls and unmapped obstacles.
inline Pose2 distantFreePose(const Course& course, const Pose2& here,
                             const std::vector<sim::Obstacle>& unmapped, Random& random) {
  for (;;) {
    const Pose2 pose = sim::randomFreePose(*course.world, {}, random, kStartClearance);
    if (distance(pose, here) < kMinKidnapDistance) continue;
    if (!sim::overlaps(pose, {}, *course.world, unmapped, 0.0, kStartClearance)) return pose;
  }
}

/// The pose displaced by 0.2 to 0.6 m and rotated by up to 0.3 rad, as by a collision.
inline Pose2 displacedPose(const Pose2& here, const Course& course,
                           const std::vector<sim::Obstacle>& unmapped, Random& random) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const double direction = random.uniform(-kPi, kPi);
    const double displacement = random.uniform(0.2, 0.6);
    const Pose2 pose{here.x + displacement * std::cos(direction),
                     here.y + displacement * std::sin(direction),
                     wrapAngle(here.yaw + random.uniform(-0.3, 0.3))};
    if (!sim::overlaps(pose, {}, *course.world, unmapped, 0.0, 0.0)) return pose;
  }
  return here;
}

inline PoseEstimate startAt(const Pose2& pose) {
  PoseEstimate start{pose, Eigen::Matrix3d::Zero()};
  start.covariance.diagonal() << 0.01, 0.01, 0.0025;
  return start;
}

inline void inject(Fault fault, const Course& course, const std::vector<sim::Obstacle>& unmapped,
                   Random& random, SimulatedDrive* drive) {
  sim::SimulatorParameters parameters = drive->simulator().parameters();
  switch (fault) {
    case Fault::kKidnap:
      drive->simulator().place(
          distantFreePose(course, drive->simulator().truth().base_in_map, unmapped, random));
      break;
    case Fault::kPush:
      drive->simulator().place(
          displacedPose(drive->simulator().truth().base_in_map, course, unmapped, random));
      break;
    case Fault::kWrongStart:
      drive->localizer().initialize(startAt(
          distantFreePose(course, drive->simulator().truth().base_in_map, unmapped, random)));
      break;
    case Fault::kCovered:
      drive->on_scan = [](Scan* scan) {
        scan->ranges.setConstant(static_cast<float>(kCoverRange));
        return true;
      };
      break;
    case Fault::kFrozen:
      drive->on_odometry = [](OdometrySample* sample) {
        sample->twist = {};
        return true;
      };
      break;
    case Fault::kScale:
      parameters.odometry.speed_scale_error = random.uniform() < 0.5 ? 0.5 : -0.4;
      drive->simulator().setParameters(parameters);
      break;
    default:
      break;
  }
}

/// Updates moving obstacles before each control step: `others(truth)` returns them.
template <typename Others>
void addTraffic(SimulatedDrive* drive, const std::vector<sim::Obstacle>& unmapped, Others others) {
  drive->before_control_step = [unmapped, others](sim::Simulator* simulator) mutable {
    std::vector<sim::Obstacle> all = others(simulator->truth());
    all.insert(all.end(), unmapped.begin(), unmapped.end());
    simulator->setObstacles(std::move(all));
  };
}

/// Places the fault's obstacles and traffic, besides the unmapped obstacles of the wrong map.
inline void placeObstacles(Fault fault, const Course& course,
                           const std::vector<sim::Obstacle>& unmapped, std::uint64_t seed,
                           Random& random, SimulatedDrive* drive) {
  const Pose2 pose = drive->simulator().truth().base_in_map;
  std::vector<sim::Obstacle> obstacles;
  if (fault == Fault::kObstacles) {
    obstacles = sim::scatterObstacles(*course.world, 10, 4, pose, random, unmapped);
  }
  obstacles.insert(obstacles.end(), unmapped.begin(), unmapped.end());
  drive->simulator().setObstacles(obstacles);
  if (fault == Fault::kCrowd) {
    addTraffic(drive, unmapped,
               [crowd = sim::Crowd(*course.world, pose, random)](const sim::Truth& car) mutable {
                 return crowd.walk(car.base_in_map, car.stamp);
               });
  }
  if (fault == Fault::kOpponent) {
    addTraffic(
        drive, unmapped,
        [opponent = sim::Opponent(seed), world = course.world](const sim::Truth& car) mutable {
          return std::vector<sim::Obstacle>{opponent.follow(car.base_in_map, car.stamp, *world)};
        });
  }
}

}  // namespace racecar_mcl
