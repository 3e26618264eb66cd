#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, DropsBadScansWithoutAChange) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  const double now = start_ + 1.0;
  const PoseEstimate before = *localizer.estimateAt(now);
  const ParticleSet particles = localizer.particles();
  const LocalizerCounters counters = localizer.counters();

  Scan blind = scanAt(now + 0.01);
  blind.ranges.setConstant(std::numeric_limits<float>::quiet_NaN());
  Scan few = scanAt(now + 0.01);
  few.ranges.tail(few.size() - 9).setConstant(-1.0f);
  Scan empty = scanAt(now + 0.01);
  empty.bearings.resize(0);
  empty.ranges.resize(0);
  empty.seconds_after_stamp.resize(0);
  const struct {
    Scan scan;
    ScanOutcome outcome;
  } bad[] = {{scanAt(now), ScanOutcome::kRepeatedStamp},
             {scanAt(now - 0.025), ScanOutcome::kOutOfOrder},
             {scanAt(now - 0.9), ScanOutcome::kOutOfOrder},
             {blind, ScanOutcome::kTooFewBeams},
             {few, ScanOutcome::kTooFewBeams},
             {empty, ScanOutcome::kTooFewBeams}};
  std::uint64_t dropped = 0;
  for (const auto& [scan, outcome] : bad) {
    EXPECT_EQ(localizer.update(scan).outcome, outcome) << toString(outcome);
    EXPECT_EQ(localizer.counters().scans_dropped, counters.scans_dropped + ++dropped);
  }
  for (const double stamp : {kNan, kInf, -kInf, 1e308, -1e308}) {
    Scan scan = scanAt(now);
    scan.stamp = stamp;
    EXPECT_EQ(localizer.update(scan).outcome, ScanOutcome::kNotFinite);
  }
  for (const double far : {kNan, kInf, 1e308, -1e308, 101.0}) {
    for (const Pose2& mount : {Pose2{far, 0.0, 0.0}, Pose2{0.0, far, 0.0}}) {
      Scan scan = scanAt(now + 0.01);
      scan.laser_in_base = mount;
      EXPECT_EQ(localizer.update(scan).outcome, ScanOutcome::kNotFinite) << far;
    }
  }
  expectSame(*localizer.estimateAt(now), before);
  EXPECT_TRUE((localizer.particles().x == particles.x).all());
  EXPECT_EQ(localizer.counters().scans_used, counters.scans_used);
  EXPECT_EQ(localizer.update(scanAt(now + 0.025)).outcome, ScanOutcome::kUsed);
}

TEST_F(LocalizerTest, DropsBadOdometryWithoutAChange) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  const double now = start_ + 1.0;
  const PoseEstimate before = *localizer.estimateAt(now);
  EXPECT_EQ(localizer.addOdometry({now + 0.02, {kNan, 0.0, 0.0}, {}}), OdometryOutcome::kNotFinite);
  EXPECT_EQ(localizer.addOdometry({kInf, {}, {}}), OdometryOutcome::kNotFinite);
  EXPECT_EQ(localizer.addOdometry({now + 0.02, {1e9, 0.0, 0.0}, {}}),
            OdometryOutcome::kImplausible);
  EXPECT_EQ(localizer.addOdometry({now, {9.0, 0.0, 0.0}, {}}), OdometryOutcome::kRepeatedStamp);
  EXPECT_EQ(localizer.addOdometry({now - 0.5, {9.0, 0.0, 0.0}, {}}), OdometryOutcome::kOutOfOrder);
  EXPECT_EQ(localizer.counters().odometry_dropped, 5u);
  EXPECT_EQ(localizer.counters().odometry_seen, 56u);
  EXPECT_EQ(localizer.counters().odometry_used, 51u);
  expectSame(*localizer.estimateAt(now), before);
  EXPECT_EQ(*localizer.newestStamp(), now);
}

TEST_F(LocalizerTest, PredictsButKeepsWeightsIfAllLikelihoodsAreZero) {
  LocalizerParameters parameters = fewBeams();
  parameters.sensor.beam.table = {0.0, 0.9, 0.1, 0.0, 8.0, 201};  // never beyond the expected range
  parameters.scan.deskew = false;
  Localizer localizer = started(parameters);
  localizer.addOdometry(odometryAt(start_ + 0.02));
  localizer.addOdometry(odometryAt(start_ + 0.04));
  Scan far = scanAt(start_ + 0.04);
  far.ranges.setConstant(9.5f);
  const ScanResult result = localizer.update(far);
  EXPECT_EQ(result.outcome, ScanOutcome::kWeightsVanished);
  EXPECT_EQ(localizer.counters().weights_vanished, 1u);
  EXPECT_EQ(localizer.counters().scans_used, 0u);
  expectNear(localizer.estimateAt(start_ + 0.04)->base_in_map, truthAt(start_ + 0.04), 0.06, 0.06);
  EXPECT_TRUE(localizer.particles().log_weight.isFinite().all());
}

}  // namespace
}  // namespace racecar_mcl
