#include "racecar_mcl/localizer.h"

#include <gtest/gtest.h>

#include <iterator>
#include <set>
#include <string>

#include "racecar_mcl/errors.h"
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
  localizer.addScan(scanAt(start_ + 2.0));
  start_pose_ = truthAt(start_ + 2.0);  // where it stands from now on
  twist_ = {};
  drive(&localizer, 2.0, 3.0);
  const LocalizerCounters& counters = localizer.counters();
  EXPECT_EQ(counters.scans_seen, 121u);
  EXPECT_GT(counters.scans_parked, 0u);
  EXPECT_EQ(counters.scans_seen, counters.scans_used + counters.scans_parked +
                                     counters.scans_dropped + counters.weights_vanished);
  EXPECT_EQ(counters.odometry_seen, 150u);
}

TEST_F(LocalizerTest, ThreePartsEqualOne) {
  Localizer in_one = started();
  Localizer in_parts = started();
  for (int i = 1; i <= 60; ++i) {
    const double stamp = start_ + i * kScanPeriod;
    in_one.addOdometry(odometryAt(stamp));
    in_parts.addOdometry(odometryAt(stamp));
    const ScanResult whole = in_one.addScan(scanAt(stamp));
    // Odometry comes in while the scan is being worked on.
    Localizer::ScanTask task = in_parts.prepareScan(scanAt(stamp));
    in_parts.addOdometry(odometryAt(stamp + 0.01));
    in_parts.processScan(&task);
    EXPECT_TRUE(in_parts.estimateAt(stamp + 0.01));
    const ScanResult parts = in_parts.commitScan(task);
    in_one.addOdometry(odometryAt(stamp + 0.01));
    ASSERT_EQ(parts.outcome, whole.outcome);
    ASSERT_EQ(parts.stamp, whole.stamp);
    expectSame(parts.update.estimate, whole.update.estimate);
    EXPECT_EQ(parts.update.effective_sample_size, whole.update.effective_sample_size);
    expectSame(*in_parts.estimateAt(stamp + 0.013), *in_one.estimateAt(stamp + 0.013));
  }
  EXPECT_EQ(in_parts.counters().scans_used, in_one.counters().scans_used);
}

TEST(ScanOutcome, EachHasItsOwnWords) {
  const ScanOutcome all[] = {ScanOutcome::kUsed,           ScanOutcome::kParked,
                             ScanOutcome::kNoMap,          ScanOutcome::kNoStart,
                             ScanOutcome::kNotFinite,      ScanOutcome::kRepeatedStamp,
                             ScanOutcome::kOutOfOrder,     ScanOutcome::kTooFewBeams,
                             ScanOutcome::kTimeJumpedBack, ScanOutcome::kWeightsVanished};
  std::set<std::string> words;
  for (const ScanOutcome outcome : all) words.insert(describe(outcome));
  EXPECT_EQ(words.size(), std::size(all));
}

TEST(LocalizerParameters, RefuseWhatCannotBe) {
  using P = LocalizerParameters;
  const auto changed = [](const auto& change) {
    P parameters;
    change(parameters);
    return parameters;
  };
  const P bad[] = {changed([](P& p) { p.filter.num_particles = 0; }),
                   changed([](P& p) { p.motion.yaw_per_metre = -1.0; }),
                   changed([](P& p) { p.sensor.beam.squash_factor = 0.0; }),
                   changed([](P& p) { p.sensor.beam.table.alpha_hit = 0.9; }),
                   changed([](P& p) { p.sensor.field.field_rand = 0.0; }),
                   changed([](P& p) { p.sensor.caster.range_method = "teleport"; }),
                   changed([](P& p) { p.sensor.caster.max_range = -1.0; }),
                   changed([](P& p) { p.sensor.caster.max_range = kInf; }),
                   changed([](P& p) { p.odometry.max_odometry_gap = 0.0; }),
                   changed([](P& p) { p.odometry.max_odometry_extrapolation = -0.1; }),
                   changed([](P& p) { p.odometry.clock_jump = kNan; }),
                   changed([](P& p) { p.num_beams_per_particle = 0; }),
                   changed([](P& p) { p.num_beams_per_particle = 1000000; }),
                   changed([](P& p) { p.min_beams = 0; }),
                   changed([](P& p) { p.min_beams = p.num_beams_per_particle + 1; }),
                   changed([](P& p) { p.scan_field_of_view = 0.0; }),
                   changed([](P& p) { p.scan_field_of_view = 7.0; }),
                   changed([](P& p) { p.scan_field_of_view = kNan; }),
                   changed([](P& p) { p.beam_box_aspect = 0.0; }),
                   changed([](P& p) { p.beam_box_aspect = kNan; }),
                   changed([](P& p) { p.parked_updates = 0; })};
  EXPECT_NO_THROW(validate(P{}));
  for (const P& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(Localizer(parameters, 1), ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
