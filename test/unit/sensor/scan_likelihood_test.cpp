#include "racecar_mcl/sensor/scan_likelihood.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "racecar_mcl/filter/particle_filter.h"
#include "support/analytic_room.h"
#include "support/map_user.h"

namespace racecar_mcl {
namespace {

const Pose2 kStart{2.0, 1.5, 0.4};

Scan scanAt(const Room& room, const Pose2& base_in_map, int beams) {
  Scan scan;
  scan.laser_in_base = {0.2, 0.0, 0.1};
  scan.bearings = Eigen::ArrayXf::LinSpaced(beams, -2.3F, 2.3F);
  scan.ranges.resize(beams);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(beams);
  const Pose2 lidar = compose(base_in_map, scan.laser_in_base);
  for (int k = 0; k < beams; ++k) {
    scan.ranges[k] = static_cast<float>(room.range(lidar, static_cast<double>(scan.bearings[k])));
  }
  return scan;
}

/// The filter's particles and estimates after some scans of a drive.
struct Outcome {
  std::vector<double> numbers;
  bool operator==(const Outcome& other) const { return numbers == other.numbers; }
};

Outcome drive(const std::string& method, int threads, int beams = 60) {
  const Room room;
  SensorParameters sensor;
  sensor.sensor_model =
      method == "field" ? SensorModelType::kLikelihoodField : SensorModelType::kBeam;
  if (method != "field") sensor.caster.range_method = method;
  MapUser map(makeLocalizationMap(room.grid(), sensor), sensor, threads);
  ParticleFilterParameters parameters;
  parameters.num_particles = parameters.max_particles = 1000;
  parameters.num_threads = threads;
  parameters.resample_threshold = 1.0;
  ParticleFilter filter(parameters, {}, 3);
  PoseEstimate start{kStart, Eigen::Matrix3d::Identity() * 0.01};
  filter.initialize(start);
  Outcome outcome;
  Pose2 car = kStart;
  for (int i = 0; i < 10; ++i) {
    Motion motion;
    motion.delta = {0.05, 0.0, 0.02};
    motion.distance = 0.05;
    motion.rotation = 0.02;
    motion.seconds = 0.025;
    car = compose(car, motion.delta);
    filter.predict(motion);
    const PoseEstimate estimate = map.update(&filter, scanAt(room, car, beams)).estimate;
    outcome.numbers.insert(outcome.numbers.end(), {estimate.base_in_map.x, estimate.base_in_map.y,
                                                   estimate.base_in_map.yaw});
  }
  const ParticleSet& particles = filter.particles();
  for (const Eigen::ArrayXd* values : {&particles.x, &particles.y, &particles.yaw}) {
    outcome.numbers.insert(outcome.numbers.end(), values->data(), values->data() + values->size());
  }
  return outcome;
}

class ScanLikelihoodWith : public testing::TestWithParam<std::string> {};

TEST_P(ScanLikelihoodWith, IsBitIdenticalForAnyNumberOfThreads) {
  const Outcome alone = drive(GetParam(), 1);
  for (const int threads : {0, 2, 3, 7}) {
    EXPECT_TRUE(drive(GetParam(), threads) == alone) << threads << " threads";
  }
}

TEST_P(ScanLikelihoodWith, HandlesMoreBeamsThanABlock) {
  const Outcome outcome = drive(GetParam(), 1, 700);
  for (const double number : outcome.numbers) ASSERT_TRUE(std::isfinite(number));
}

INSTANTIATE_TEST_SUITE_P(Models, ScanLikelihoodWith,
                         testing::Values("field", "bresenham", "simd", "lut"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace racecar_mcl
