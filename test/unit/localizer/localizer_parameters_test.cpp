// Parameters that change between two scans.
#include <gtest/gtest.h>

#include <functional>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, KeepsPoseParticlesAndStatusIfParametersChange) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 2.0);
  const PoseEstimate before = *localizer.estimateAt(start_ + 2.0);
  const LocalizationState state = localizer.status().state;
  LocalizerParameters changed = fewBeams();
  changed.filter.num_particles = 345;
  changed.motion.yaw_noise_from_translation = 0.06;
  changed.scan.min_beams = 12;
  localizer.setParameters(changed, localizer.map());
  EXPECT_EQ(localizer.estimateAt(start_ + 2.0)->base_in_map.x, before.base_in_map.x);
  EXPECT_EQ(localizer.status().state, state);
  EXPECT_EQ(localizer.particles().size(), 200);
  drive(&localizer, 2.0, 2.1);
  EXPECT_EQ(localizer.particles().size(), 345);
  drive(&localizer, 2.1, 4.0);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, truthAt(start_ + 4.0), 0.1, 0.05);
  changed.filter.num_particles = 50;
  localizer.setParameters(changed, localizer.map());
  drive(&localizer, 4.0, 4.1);
  EXPECT_LT(localizer.particles().size(), 345) << "by KLD sampling, as far as the set is narrow";
}

TEST_F(LocalizerTest, TakesAnotherSensorModelWithAMapThatWasBuiltForIt) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  LocalizerParameters changed = fewBeams();
  changed.sensor.sensor_model = SensorModelType::kLikelihoodField;
  EXPECT_TRUE(needsNewMap(fewBeams(), changed));
  EXPECT_THROW(localizer.setParameters(changed, localizer.map()), std::invalid_argument);
  EXPECT_EQ(localizer.parameters().sensor.sensor_model, SensorModelType::kBeam);
  localizer.setParameters(changed, map(changed));
  drive(&localizer, 1.0, 3.0);
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.1, 0.05);
}

TEST_F(LocalizerTest, AWrongParameterChangesNothing) {
  Localizer localizer = started();
  LocalizerParameters wrong = fewBeams();
  wrong.filter.num_particles = 100;
  wrong.monitor.lost_conflict = -1.0;
  EXPECT_THROW(localizer.setParameters(wrong, localizer.map()), ParameterError);
  EXPECT_EQ(localizer.parameters().filter.num_particles, 200);
}

TEST_F(LocalizerTest, EachComponentFollowsChangedParameters) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  EXPECT_EQ(localizer.calibration().distanceScale(), 1.0);
  const ProtectionLevel before = localizer.status().level;
  LocalizerParameters changed = fewBeams();
  changed.scan.num_beams_per_particle = 30;
  changed.range_bias.range_bias = 0.01;
  changed.calibration.calibration_distance = 5.0;
  changed.scan_direction = ScanDirectionFrom::kReversed;
  changed.protection.integrity_risk = 1e-6;
  changed.odometry.max_odometry_extrapolation = 0.0;
  changed.slip_compensation = false;  // extrapolates at the estimated speed
  localizer.setParameters(changed, localizer.map());
  EXPECT_TRUE(localizer.sensorCalibration().lidars.at(0).scan_reversed);
  ScanResult last;
  drive(&localizer, 1.0, 1.1, [&](const ScanResult& result) { last = result; });
  EXPECT_EQ(last.update.beams, 30);
  EXPECT_EQ(last.range_bias, 0.01);
  EXPECT_NE(localizer.calibration().distanceScale(), 1.0);
  EXPECT_GT(last.status.level.along, 1.2 * before.along);
  const double newest = *localizer.newestStamp();
  EXPECT_EQ(localizer.estimateAt(newest + 0.2)->base_in_map.x,
            localizer.estimateAt(newest)->base_in_map.x);
}

TEST_F(LocalizerTest, LidarOdometryFollowsChangedParameters) {
  LocalizerParameters changed = fewBeams();
  changed.filter.num_particles = 60;
  changed.motion.yaw_noise_from_translation = 0.1;
  changed.sensor.field.field_scale = 0.2;
  const auto estimateFrom = [&](const LocalizerParameters& first) {
    Localizer localizer(first, 1);
    // The walls of the map are elsewhere, so that scans are matched with each other.
    const auto map = makeLocalizationMap(Room{16.0, 10.0}.grid(), changed);
    localizer.setParameters(changed, map);
    localizer.addOdometry(odometryAt(start_));
    localizer.initialize(startAt(start_pose_));
    drive(&localizer, 0.0, 3.0);
    return *localizer.estimateAt(start_ + 3.0);
  };
  expectSame(estimateFrom(fewBeams()), estimateFrom(changed));
}

TEST_F(LocalizerTest, TheSensorModelFollowsChangedParameters) {
  const auto estimateWith = [this](double effective_beams) {
    Localizer localizer = started();
    LocalizerParameters changed = fewBeams();
    changed.effective_beams = effective_beams;
    localizer.setParameters(changed, map(changed));
    drive(&localizer, 0.0, 0.5);
    return *localizer.estimateAt(start_ + 0.5);
  };
  EXPECT_GT(estimateWith(5.0).covariance.trace(), 1.2 * estimateWith(40.0).covariance.trace());
}

TEST_F(LocalizerTest, TheLeastNumberOfBeamsIsAParameter) {
  LocalizerParameters parameters = fewBeams();
  Scan scan = scanAt(start_ + kScanPeriod);
  scan.ranges.tail(scan.size() - 30).setConstant(static_cast<float>(kNan));
  parameters.scan.min_beams = 30;
  EXPECT_EQ(started(parameters).update(scan).outcome, ScanOutcome::kUsed);
  parameters.scan.min_beams = 31;
  EXPECT_EQ(started(parameters).update(scan).outcome, ScanOutcome::kTooFewBeams);
}

TEST_F(LocalizerTest, TheAcquisitionOrderOfTheBeamsIsAParameter) {
  LocalizerParameters parameters = fewBeams();
  EXPECT_FALSE(started(parameters).sensorCalibration().lidars.at(0).scan_reversed);
  parameters.scan_direction = ScanDirectionFrom::kReversed;
  EXPECT_TRUE(started(parameters).sensorCalibration().lidars.at(0).scan_reversed);
}

TEST(LocalizerParameters, AreCheckedInEveryPart) {
  using P = LocalizerParameters;
  const std::function<void(P&)> mistakes[] = {
      [](P& p) { p.filter.num_particles = 0; },
      [](P& p) { p.motion.yaw_noise_from_rotation = -1.0; },
      [](P& p) { p.scan.min_beams = 0; },
      [](P& p) { p.sensor.field.z_rand = 2.0; },
      [](P& p) { p.odometry.clock_jump = 0.0; },
      [](P& p) { p.calibration.calibration_distance = -1.0; },
      [](P& p) { p.range_bias.range_bias = 1.0; },
      [](P& p) { p.monitor.lost_conflict = -1.0; },
      [](P& p) { p.protection.integrity_risk = 0.0; }};
  EXPECT_NO_THROW(validate(P{}));
  for (const auto& mistake : mistakes) {
    P parameters;
    mistake(parameters);
    EXPECT_THROW(validate(parameters), ParameterError) << &mistake - mistakes;
  }
}

TEST(LocalizerParameters, GiveEverySensorModelTheExponentOfTheEffectiveBeams) {
  LocalizerParameters parameters;
  parameters.effective_beams = 25.0;
  parameters.scan.num_beams_per_particle = 100;
  const SensorParameters sensor = sensorParameters(parameters);
  EXPECT_EQ(sensor.field.likelihood_exponent, 0.25);
  EXPECT_EQ(sensor.beam.likelihood_exponent, 0.25);
  EXPECT_EQ(sensor.search.likelihood_exponent, 0.25);
  parameters.effective_beams = 200.0;
  EXPECT_EQ(sensorParameters(parameters).field.likelihood_exponent, 1.0);
}

TEST(NeedsNewMap, IfWhatTheMapIsBuiltFromDiffers) {
  const LocalizerParameters before;
  LocalizerParameters after = before;
  after.filter.num_particles = 300;
  after.motion.yaw_noise_from_rotation = 0.5;
  EXPECT_FALSE(needsNewMap(before, after));
  after.sensor.field.field_scale = 0.1;
  EXPECT_TRUE(needsNewMap(before, after));
  after = before;
  after.effective_beams = 20.0;
  EXPECT_TRUE(needsNewMap(before, after));
}

}  // namespace
}  // namespace racecar_mcl
