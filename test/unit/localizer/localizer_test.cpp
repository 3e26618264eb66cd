#include "racecar_mcl/localizer/localizer.h"

#include <gtest/gtest.h>

#include <iterator>
#include <set>
#include <string>
#include <thread>

#include "racecar_mcl/common/errors.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, CountsEveryScanOnce) {
  Localizer localizer(fewBeams(), 1);
  drive(&localizer, 0.0, 0.2);
  localizer.setMap(map());
  drive(&localizer, 0.2, 0.4);
  localizer.initialize(startAt(truthAt(start_ + 0.4)));
  drive(&localizer, 0.4, 2.0);
  localizer.update(scanAt(start_ + 2.0));
  start_pose_ = truthAt(start_ + 2.0);  // stationary from now on
  twist_ = {};
  drive(&localizer, 2.0, 3.0);
  const LocalizerCounters& counters = localizer.counters();
  EXPECT_EQ(counters.scans_seen, 121u);
  EXPECT_GT(counters.scans_stationary, 0u);
  EXPECT_EQ(counters.scans_seen, counters.scans_used + counters.scans_stationary +
                                     counters.scans_dropped + counters.weights_vanished);
  EXPECT_EQ(counters.odometry_seen, 150u);
}

TEST_F(LocalizerTest, AcceptsOdometryFromAnotherThreadDuringAScan) {
  Localizer localizer = started();
  std::thread odometry([&] {
    for (int i = 1; i <= 5000; ++i) {
      localizer.addOdometry(odometryAt(start_ + i * 4e-4));
      localizer.estimateAt(start_ + i * 4e-4);
    }
  });
  // Stamps further ahead of the odometry are outliers at first.
  while (*localizer.newestStamp() < start_ + kScanPeriod) std::this_thread::yield();
  for (int i = 1; i <= 80; ++i) {
    EXPECT_TRUE(hasEstimate(localizer.update(scanAt(start_ + i * kScanPeriod)).outcome));
  }
  odometry.join();
  EXPECT_EQ(localizer.counters().odometry_used, 5001u);
  EXPECT_EQ(localizer.counters().scans_seen, 80u);
}

TEST(ScanOutcome, EachHasItsOwnText) {
  const ScanOutcome all[] = {
      ScanOutcome::kUsed,           ScanOutcome::kStationary,     ScanOutcome::kNoMap,
      ScanOutcome::kNoStart,        ScanOutcome::kNotFinite,      ScanOutcome::kRepeatedStamp,
      ScanOutcome::kStampOutlier,   ScanOutcome::kOutOfOrder,     ScanOutcome::kTooFewBeams,
      ScanOutcome::kTimeJumpedBack, ScanOutcome::kWeightsVanished};
  std::set<std::string> words;
  for (const ScanOutcome outcome : all) words.insert(toString(outcome));
  EXPECT_EQ(words.size(), std::size(all));
}

TEST(LocalizerParameters, RejectValuesOutOfRange) {
  using P = LocalizerParameters;
  const auto changed = [](const auto& change) {
    P parameters;
    change(parameters);
    return parameters;
  };
  const P bad[] = {changed([](P& p) { p.filter.num_particles = 0; }),
                   changed([](P& p) { p.motion.yaw_noise_from_translation = -1.0; }),
                   changed([](P& p) { p.effective_beams = 0.0; }),
                   changed([](P& p) { p.sensor.beam.table.alpha_hit = 0.9; }),
                   changed([](P& p) { p.sensor.field.z_rand = 0.0; }),
                   changed([](P& p) { p.sensor.caster.range_method = "teleport"; }),
                   changed([](P& p) { p.sensor.caster.max_range = -1.0; }),
                   changed([](P& p) { p.sensor.caster.max_range = kInf; }),
                   changed([](P& p) { p.odometry.max_odometry_gap = 0.0; }),
                   changed([](P& p) { p.odometry.max_odometry_extrapolation = -0.1; }),
                   changed([](P& p) { p.odometry.clock_jump = kNan; }),
                   changed([](P& p) { p.scan.num_beams_per_particle = 0; }),
                   changed([](P& p) { p.scan.num_beams_per_particle = 1000000; }),
                   changed([](P& p) { p.scan.min_beams = 0; }),
                   changed([](P& p) { p.scan.min_beams = p.scan.num_beams_per_particle + 1; }),
                   changed([](P& p) { p.scan.scan_field_of_view = 0.0; }),
                   changed([](P& p) { p.scan.scan_field_of_view = 7.0; }),
                   changed([](P& p) { p.scan.scan_field_of_view = kNan; }),
                   changed([](P& p) { p.scan.beam_box_aspect = 0.0; }),
                   changed([](P& p) { p.scan.beam_box_aspect = kNan; }),
                   changed([](P& p) { p.stationary_updates = 0; })};
  EXPECT_NO_THROW(validate(P{}));
  for (const P& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(Localizer(parameters, 1), ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
