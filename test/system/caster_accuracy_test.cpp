// The fast casters do not reduce accuracy: the same drives and seeds with exact traversal and with
// each fast caster.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "evaluation/trajectory_error.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "racecar_mcl/map/map_io.h"
#include "sim/recorded_drive.h"

namespace racecar_mcl {
namespace {

const std::string kMap = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
constexpr int kDrives = 6;
constexpr double kDriveSeconds = 12.0;
constexpr double kSettled = 2.0;  // s, until the initial error is corrected

struct Drive {
  std::vector<sim::Event> events;
  std::uint64_t seed = 0;
};

std::vector<Drive> recordDrives() {
  const auto world = std::make_shared<const sim::World>(loadMap(sim::worldPathFor(kMap)));
  Pose2 start;
  EXPECT_TRUE(sim::loadStartPose(kMap, start));
  std::vector<Drive> drives;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    drives.push_back({sim::recordDrive(world, {}, {}, start, kDriveSeconds, seed), seed});
  }
  return drives;
}

PoseEstimate at(const Pose2& base_in_map) {
  PoseEstimate start;
  start.base_in_map = base_in_map;
  return start;
}

/// Mean position error (m) after kSettled.
double meanError(const Drive& drive, const LocalizerParameters& parameters,
                 const std::shared_ptr<const LocalizationMap>& map) {
  Localizer localizer(parameters, drive.seed);
  localizer.setMap(map);
  std::vector<double> errors;
  for (const sim::Event& event : drive.events) {
    if (const auto* odometry = std::get_if<OdometrySample>(&event.data)) {
      localizer.addOdometry(*odometry);
    } else if (const auto* sweep = std::get_if<sim::LidarScan>(&event.data)) {
      localizer.update(sim::toScan(*sweep));
    } else {
      const auto& truth = std::get<sim::Truth>(event.data);
      if (!localizer.initialized()) localizer.initialize(at(truth.base_in_map));
      if (truth.stamp < kSettled) continue;
      errors.push_back(distance(localizer.estimateAt(truth.stamp)->base_in_map, truth.base_in_map));
    }
  }
  return mean(errors);
}

double meanError(const std::vector<Drive>& drives, const std::string& range_method) {
  LocalizerParameters parameters;
  parameters.sensor.sensor_model = SensorModelType::kBeam;
  parameters.sensor.caster.range_method = range_method;
  const auto map = makeLocalizationMap(loadMap(kMap), parameters);
  std::vector<double> errors;
  for (const Drive& drive : drives) errors.push_back(meanError(drive, parameters, map));
  return mean(errors);
}

TEST(CasterAccuracy, FastCastersLocalizeAsWellAsExactTraversal) {
  const std::vector<Drive> drives = recordDrives();
  const double exact = meanError(drives, "bresenham");
  RecordProperty("bresenham_m", std::to_string(exact));
  for (const std::string method : {"simd", "lut"}) {
    const double error = meanError(drives, method);
    RecordProperty(method + "_m", std::to_string(error));
    EXPECT_LE(error, 1.05 * exact) << method;
  }
}

}  // namespace
}  // namespace racecar_mcl
