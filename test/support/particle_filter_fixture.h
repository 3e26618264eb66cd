// A small room with scans, and particle filters in it.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "support/ascii_map.h"
#include "support/map_user.h"

namespace racecar_mcl {

// 3 x 1.6 m with an alcove and a pillar: unambiguous.
constexpr const char* kRoom = R"(
    ##############################
    #............................#
    #............................#
    #......##....................#
    #......##................#####
    #........................#####
    #............................#
    #............................#
    #............................#
    #............................#
    #####........................#
    #####..............###.......#
    #####......................###
    #..........................###
    #............................#
    ##############################)";

inline BeamModelParameters beamModel() {
  BeamModelParameters parameters;
  parameters.table = {0.74, 0.07, 0.07, 0.12, 2.0, 101};
  parameters.likelihood_exponent = 1.0 / 2.2;
  return parameters;
}

inline SensorParameters sensor(const BeamModelParameters& beam, double max_range = 0.0) {
  SensorParameters parameters;
  parameters.sensor_model = SensorModelType::kBeam;
  parameters.caster = {"bresenham", max_range, UnknownIs::kFree};
  parameters.beam = beam;
  return parameters;
}

/// The room as a grid that is rotated by 0.2 rad.
inline OccupancyGrid roomGrid() { return asciiMap(kRoom, 0.1, {-1.0, 0.5, 0.2}); }

inline MapUser roomWith(const SensorParameters& parameters) {
  return MapUser(makeLocalizationMap(roomGrid(), parameters), parameters);
}

inline MapUser room(const BeamModelParameters& beam = beamModel()) {
  return roomWith(sensor(beam));
}

// The car in the middle of the room, whose grid is rotated by 0.2 rad.
constexpr Pose2 kTruth{0.4, 1.6, 0.7};

inline Scan scanFrom(const LocalizationMap& map, const Pose2& base_in_map) {
  Scan scan;
  scan.laser_in_base = {0.1, 0.02, 0.05};
  scan.bearings = Eigen::ArrayXf::LinSpaced(10, -2.3f, 2.3f);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(10);
  const Pose2 lidar = compose(base_in_map, scan.laser_in_base);
  Eigen::ArrayXXf ranges(10, 1);
  map.caster->cast(batchOf(lidar), scan.bearings, ranges);
  // Lidar noise, so that the true pose is not the most likely one.
  for (Eigen::Index k = 0; k < 10; ++k) {
    ranges(k, 0) += 0.08f * std::sin(3.0f * static_cast<float>(k));
  }
  scan.ranges = ranges.col(0);
  return scan;
}

inline ParticleFilterParameters sized(int count, double threshold) {
  ParticleFilterParameters parameters;
  parameters.num_particles = count;
  parameters.max_particles = std::max(count, 20000);
  parameters.resample_threshold = threshold;
  parameters.min_effective_particles = 0;
  parameters.estimate = EstimateFrom::kMean;
  parameters.regularization_updates = 0;
  return parameters;
}

inline MotionModelParameters constantNoise(double position_sigma) {
  MotionModelParameters parameters;
  parameters.motion_model = MotionNoise::kConstant;
  parameters.constant_x_sigma = parameters.constant_y_sigma = position_sigma;
  parameters.constant_yaw_sigma = 0.0;
  return parameters;
}

inline PoseEstimate startAt(const Pose2& pose, const Eigen::Vector3d& sigma) {
  return {pose, Eigen::Matrix3d(sigma.array().square().matrix().asDiagonal())};
}

}  // namespace racecar_mcl
