#include "racecar_mcl/localizer.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "racecar_mcl/errors.h"
#include "support/room.h"

namespace racecar_mcl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kOdometryPeriod = 0.02;  // s
constexpr double kScanPeriod = 0.025;     // s

/// Not the defaults, which are tuned for other places than this bare room.
LocalizerParameters fewBeams() {
  LocalizerParameters parameters;
  parameters.calibration.calibration_distance = 0.0;  // motions are to be exact
  parameters.sensor.sensor_model = SensorModel::kBeam;
  parameters.scan_field_of_view = 4.71;
  parameters.motion.motion_model = MotionNoise::kAckermann;
  parameters.motion.along_per_metre = 0.1;
  parameters.motion.across_per_metre = 0.05;
  parameters.motion.yaw_per_metre = 0.05;
  parameters.motion.yaw_per_radian = 0.1;
  parameters.num_beams_per_particle = 40;
  parameters.min_beams = 10;
  parameters.parked_updates = 5;
  parameters.filter.estimate = EstimateFrom::kMean;
  return parameters;
}

void expectNear(const Pose2& a, const Pose2& b, double metres, double radians) {
  EXPECT_NEAR(a.x, b.x, metres);
  EXPECT_NEAR(a.y, b.y, metres);
  EXPECT_NEAR(wrapAngle(a.yaw - b.yaw), 0.0, radians);
}

void expectSame(const PoseEstimate& a, const PoseEstimate& b) {
  EXPECT_EQ(a.base_in_map.x, b.base_in_map.x);
  EXPECT_EQ(a.base_in_map.y, b.base_in_map.y);
  EXPECT_EQ(a.base_in_map.yaw, b.base_in_map.yaw);
  EXPECT_TRUE((a.covariance.array() == b.covariance.array()).all());
}

PoseEstimate startAt(const Pose2& pose, double sigma = 0.1) {
  return {pose, sigma * sigma * Eigen::Matrix3d::Identity()};
}

/// A car that drives a circle in a room of 8 x 5 m from time `start_` on.
class LocalizerTest : public testing::Test {
 protected:
  Room room_;
  Sweep sweep_{180, 4.7, 0.0, {0.27, 0.03, 0.05}};
  Twist2 twist_{1.5, 0.0, 1.0};
  Pose2 start_pose_{4.0, 1.0, 0.0};
  double start_ = 100.0;

  Pose2 truthAt(double stamp) const {
    return compose(start_pose_, integrate(twist_, stamp - start_));
  }

  Scan scanAt(double stamp) const {
    return takeScan(room_, sweep_, stamp, [&](double t) { return truthAt(t); });
  }

  OdometrySample odometryAt(double stamp) const { return {stamp, twist_, {}}; }

  std::shared_ptr<MapModel> map(const LocalizerParameters& parameters = fewBeams()) const {
    return makeMapModel(room_.grid(), parameters);
  }

  Localizer started(const LocalizerParameters& parameters = fewBeams(),
                    std::uint64_t seed = 1) const {
    Localizer localizer(parameters, seed);
    localizer.setMap(map(parameters));
    localizer.addOdometry(odometryAt(start_));
    localizer.initialize(startAt(start_pose_));
    return localizer;
  }

  /// Odometry and scans in the order of their stamps, over (from, to] after `start_`.
  void drive(Localizer* localizer, double from, double to,
             const std::function<void(const ScanResult&)>& each = {}) const {
    auto odometry = static_cast<int>(std::floor(from / kOdometryPeriod + 1e-6)) + 1;
    auto scan = static_cast<int>(std::floor(from / kScanPeriod + 1e-6)) + 1;
    for (;;) {
      const double next_odometry = odometry * kOdometryPeriod;
      const double next_scan = scan * kScanPeriod;
      if (std::min(next_odometry, next_scan) > to + 1e-6) return;
      if (next_odometry <= next_scan) {
        localizer->addOdometry(odometryAt(start_ + next_odometry));
        ++odometry;
      } else {
        const ScanResult result = localizer->addScan(scanAt(start_ + next_scan));
        if (each) each(result);
        ++scan;
      }
    }
  }
};

struct Models {
  SensorModel sensor;
  MotionNoise motion;
};

class FollowingModels : public LocalizerTest, public testing::WithParamInterface<Models> {};

TEST_P(FollowingModels, FollowTheCar) {
  LocalizerParameters parameters = fewBeams();
  parameters.sensor.sensor_model = GetParam().sensor;
  parameters.motion.motion_model = GetParam().motion;
  parameters.sensor.beam.table.sigma_hit = 2.0;
  parameters.sensor.field = {0.05, 0.05, 30.0, 2.0, 1.0};
  parameters.filter.num_particles = 400;
  Localizer localizer = started(parameters);
  double worst = 0.0;
  drive(&localizer, 0.0, 4.0, [&](const ScanResult& result) {
    EXPECT_EQ(result.outcome, ScanOutcome::kUsed);
    if (result.stamp < start_ + 1.0) return;
    worst = std::max(worst, distance(result.update.estimate.base_in_map, truthAt(result.stamp)));
  });
  EXPECT_LT(worst, 0.06);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, truthAt(start_ + 4.0), 0.05, 0.03);
}

INSTANTIATE_TEST_SUITE_P(
    AllModels, FollowingModels,
    testing::Values(Models{SensorModel::kBeam, MotionNoise::kConstant},
                    Models{SensorModel::kBeam, MotionNoise::kDifferential},
                    Models{SensorModel::kBeam, MotionNoise::kAckermann},
                    Models{SensorModel::kLikelihoodField, MotionNoise::kConstant},
                    Models{SensorModel::kLikelihoodField, MotionNoise::kDifferential},
                    Models{SensorModel::kLikelihoodField, MotionNoise::kAckermann}));

TEST_F(LocalizerTest, FollowsTheCarByItsDefaults) {
  Localizer localizer = started(LocalizerParameters{});
  drive(&localizer, 0.0, 4.0);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, truthAt(start_ + 4.0), 0.08, 0.05);
}

class ShortReturnsTest : public LocalizerTest {
 protected:
  /// As the room shows it, but with something unmapped in the way of the middle beams.
  Scan blocked(double stamp, int beams) const {
    Scan scan = scanAt(stamp);
    scan.ranges.segment(scan.size() / 2 - beams / 2, beams) =
        scan.ranges.segment(scan.size() / 2 - beams / 2, beams).min(0.7f);
    return scan;
  }

  /// Beams weighed of the scan after a drive of 1 s in which nothing was in the way.
  ScanResult meet(int beams, bool reject) const {
    LocalizerParameters parameters = fewBeams();
    parameters.reject_short_returns = reject;
    Localizer localizer = started(parameters);
    drive(&localizer, 0.0, 1.0, [&](const ScanResult& result) {
      EXPECT_EQ(result.update.beams, 40) << "nothing is in the way";
    });
    EXPECT_EQ(localizer.verdict().state, VerdictState::kLocalized);
    localizer.addOdometry(odometryAt(start_ + 1.02));
    return localizer.addScan(blocked(start_ + 1.02, beams));
  }
};

TEST_F(ShortReturnsTest, AreNotWeighedWhileLocalizedButStillJudged) {
  const ScanResult rejected = meet(27, true);  // every 4.5th beam is chosen
  EXPECT_EQ(rejected.update.beams, 34);
  const ScanResult weighed = meet(27, false);
  EXPECT_EQ(weighed.update.beams, 40);
  EXPECT_LT(rejected.verdict.explained, 0.999);
  EXPECT_NEAR(rejected.verdict.explained, weighed.verdict.explained, 1e-3);
}

TEST_F(ShortReturnsTest, AreAllWeighedWhereMostBeamsAreShort) {
  EXPECT_EQ(meet(120, true).update.beams, 40);
}

TEST_F(ShortReturnsTest, AreWeighedUntilLocalized) {
  LocalizerParameters parameters = fewBeams();
  parameters.reject_short_returns = true;
  Localizer localizer = started(parameters);
  ASSERT_EQ(localizer.verdict().state, VerdictState::kConverging);
  EXPECT_EQ(localizer.addScan(blocked(start_, 27)).update.beams, 40);
}

TEST_F(LocalizerTest, ChoosesBeamsByTheLayout) {
  LocalizerParameters parameters = fewBeams();
  const Scan scan = scanAt(start_);
  const Scan even = chooseBeams(parameters, scan);
  parameters.beam_layout = BeamLayout::kBoxed;
  const Scan boxed = chooseBeams(parameters, scan);
  EXPECT_EQ(even.size(), 40);
  EXPECT_EQ(boxed.size(), 40);
  EXPECT_GT((boxed.bearings.abs() < 0.5f).count(), (even.bearings.abs() < 0.5f).count());
  double worst = 0.0;
  Localizer localizer = started(parameters);
  drive(&localizer, 0.0, 2.0, [&](const ScanResult& result) {
    EXPECT_EQ(result.update.beams, 40);
    worst = std::max(worst, distance(result.update.estimate.base_in_map, truthAt(result.stamp)));
  });
  EXPECT_LT(worst, 0.15);
}

TEST_F(LocalizerTest, WaitsForAMapThenForAStart) {
  Localizer localizer(fewBeams(), 1);
  EXPECT_FALSE(localizer.newestStamp());
  localizer.addOdometry(odometryAt(start_));
  EXPECT_EQ(localizer.addScan(scanAt(start_)).outcome, ScanOutcome::kNoMap);
  EXPECT_FALSE(localizer.hasMap());
  EXPECT_FALSE(localizer.initializeGlobally());
  EXPECT_FALSE(localizer.initialized());
  localizer.setMap(map());
  EXPECT_TRUE(localizer.hasMap());
  EXPECT_EQ(localizer.addScan(scanAt(start_)).outcome, ScanOutcome::kNoStart);
  EXPECT_FALSE(localizer.estimateAt(start_));
  localizer.initialize(startAt(start_pose_));
  EXPECT_EQ(localizer.addScan(scanAt(start_)).outcome, ScanOutcome::kUsed);
  EXPECT_EQ(localizer.counters().scans_seen, 3u);
  EXPECT_EQ(localizer.counters().scans_dropped, 2u);
  EXPECT_EQ(localizer.counters().scans_used, 1u);
}

TEST_F(LocalizerTest, AStartMayComeBeforeTheMap) {
  Localizer localizer(fewBeams(), 1);
  localizer.initialize(startAt(start_pose_));
  EXPECT_EQ(localizer.addScan(scanAt(start_)).outcome, ScanOutcome::kNoMap);
  localizer.setMap(map());
  EXPECT_EQ(localizer.addScan(scanAt(start_)).outcome, ScanOutcome::kUsed);
}

TEST_F(LocalizerTest, DropsBadScansAndStaysAsItWas) {
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
    EXPECT_EQ(localizer.addScan(scan).outcome, outcome) << describe(outcome);
    EXPECT_EQ(localizer.counters().scans_dropped, counters.scans_dropped + ++dropped);
  }
  for (const double stamp : {kNan, kInf, -kInf}) {
    Scan scan = scanAt(now);
    scan.stamp = stamp;
    EXPECT_EQ(localizer.addScan(scan).outcome, ScanOutcome::kNotFinite);
  }
  expectSame(*localizer.estimateAt(now), before);
  EXPECT_TRUE((localizer.particles().x == particles.x).all());
  EXPECT_EQ(localizer.counters().scans_used, counters.scans_used);
  EXPECT_EQ(localizer.addScan(scanAt(now + 0.025)).outcome, ScanOutcome::kUsed);
}

TEST_F(LocalizerTest, DropsBadOdometryAndStaysAsItWas) {
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

TEST_F(LocalizerTest, CountsEveryScanOnce) {
  Localizer localizer(fewBeams(), 1);
  drive(&localizer, 0.0, 0.2);
  localizer.setMap(map());
  drive(&localizer, 0.2, 0.4);
  localizer.initialize(startAt(truthAt(start_ + 0.4)));
  drive(&localizer, 0.4, 2.0);
  localizer.addScan(scanAt(start_ + 2.0));
  twist_ = {};
  start_pose_ = truthAt(start_);
  drive(&localizer, 2.0, 3.0);
  const LocalizerCounters& counters = localizer.counters();
  EXPECT_EQ(counters.scans_seen, 121u);
  EXPECT_GT(counters.scans_parked, 0u);
  EXPECT_EQ(counters.scans_seen, counters.scans_used + counters.scans_parked +
                                     counters.scans_dropped + counters.weights_vanished);
  EXPECT_EQ(counters.odometry_seen, 150u);
}

TEST_F(LocalizerTest, MovesOnButWeighsNothingWhereNoParticleCanHaveSeenTheScan) {
  LocalizerParameters parameters = fewBeams();
  parameters.sensor.beam.table = {0.0, 0.9, 0.1, 0.0, 8.0, 201};  // never beyond the expected range
  parameters.deskew = false;
  Localizer localizer = started(parameters);
  localizer.addOdometry(odometryAt(start_ + 0.02));
  localizer.addOdometry(odometryAt(start_ + 0.04));
  Scan far = scanAt(start_ + 0.04);
  far.ranges.setConstant(9.5f);
  const ScanResult result = localizer.addScan(far);
  EXPECT_EQ(result.outcome, ScanOutcome::kWeightsVanished);
  EXPECT_EQ(localizer.counters().weights_vanished, 1u);
  EXPECT_EQ(localizer.counters().scans_used, 0u);
  expectNear(localizer.estimateAt(start_ + 0.04)->base_in_map, truthAt(start_ + 0.04), 0.06, 0.06);
  EXPECT_TRUE(localizer.particles().log_weight.isFinite().all());
}

TEST_F(LocalizerTest, RestsOnceAParkedCarHasSeenEnough) {
  twist_ = {};
  Localizer localizer = started();  // parked_updates = 5
  int used = 0, parked = 0;
  PoseEstimate last;
  drive(&localizer, 0.0, 1.0, [&](const ScanResult& result) {
    (result.outcome == ScanOutcome::kUsed ? used : parked) += 1;
    if (result.outcome == ScanOutcome::kUsed) {
      EXPECT_EQ(parked, 0);
      last = result.update.estimate;
    } else {
      EXPECT_EQ(result.outcome, ScanOutcome::kParked);
      expectSame(result.update.estimate, last);
    }
  });
  EXPECT_EQ(used, 5);
  EXPECT_EQ(parked, 35);
  expectSame(*localizer.estimateAt(start_ + 1.0), last);

  // Asked to look again, it does; driving on, it does so all the time.
  localizer.requestUpdate();
  EXPECT_EQ(localizer.addScan(scanAt(start_ + 1.01)).outcome, ScanOutcome::kUsed);
  drive(&localizer, 1.01, 1.5);
  start_pose_ = truthAt(start_ + 1.5);
  twist_ = {1.5, 0.0, 1.0};
  start_ += 1.5;
  drive(&localizer, 0.0, 1.0,
        [&](const ScanResult& result) { EXPECT_EQ(result.outcome, ScanOutcome::kUsed); });
}

TEST_F(LocalizerTest, AParkedCarsCloudDoesNotGrow) {
  twist_ = {};
  LocalizerParameters parameters = fewBeams();
  parameters.parked_updates = 1000;
  Localizer localizer = started(parameters);
  drive(&localizer, 0.0, 1.0);
  const double before = localizer.estimateAt(start_ + 1.0)->covariance.trace();
  drive(&localizer, 1.0, 10.0);
  EXPECT_LE(localizer.estimateAt(start_ + 10.0)->covariance.trace(), before);
}

TEST_F(LocalizerTest, SilentOdometryIsNoSignThatTheCarStands) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  // Scans go on, odometry does not: none of them may be skipped after a while.
  for (int i = 60; i < 200; ++i) {
    const double stamp = start_ + 1.0 + i * kScanPeriod;
    EXPECT_EQ(localizer.addScan(scanAt(stamp)).outcome, ScanOutcome::kUsed);
  }
}

TEST_F(LocalizerTest, ANewMapIsSwappedInWithoutLosingThePose) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  const PoseEstimate before = *localizer.estimateAt(start_ + 1.0);
  const ParticleSet particles = localizer.particles();
  localizer.setMap(map());
  expectSame(*localizer.estimateAt(start_ + 1.0), before);
  EXPECT_TRUE((localizer.particles().x == particles.x).all());
  double worst = 0.0;
  drive(&localizer, 1.0, 2.0, [&](const ScanResult& result) {
    EXPECT_EQ(result.outcome, ScanOutcome::kUsed);
    worst = std::max(worst, distance(result.update.estimate.base_in_map, truthAt(result.stamp)));
  });
  EXPECT_LT(worst, 0.08);
}

TEST_F(LocalizerTest, WeighsByTheNewMapFromThenOn) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  // The same room, 6 cm farther along x: the pose follows the map.
  GridGeometry shifted = room_.grid().geometry();
  shifted.origin.x += 0.06;
  localizer.setMap(makeMapModel(OccupancyGrid(shifted, room_.grid().cells()), fewBeams()));
  drive(&localizer, 1.0, 4.0);
  const Pose2 truth = truthAt(start_ + 4.0);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, {truth.x + 0.06, truth.y, truth.yaw},
             0.04, 0.03);
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

TEST_F(LocalizerTest, OneSeedGivesOneRunBitForBit) {
  const auto run = [&](std::uint64_t seed) {
    Localizer localizer = started(fewBeams(), seed);
    drive(&localizer, 0.0, 2.0);
    return localizer;
  };
  const Localizer a = run(7), b = run(7), c = run(8);
  expectSame(*a.estimateAt(start_ + 2.0), *b.estimateAt(start_ + 2.0));
  EXPECT_TRUE((a.particles().x == b.particles().x && a.particles().y == b.particles().y &&
               a.particles().yaw == b.particles().yaw &&
               a.particles().log_weight == b.particles().log_weight)
                  .all());
  EXPECT_NE(a.estimateAt(start_ + 2.0)->base_in_map.x, c.estimateAt(start_ + 2.0)->base_in_map.x);
}

TEST_F(LocalizerTest, CarriesThePoseToAnyTime) {
  Localizer localizer = started();
  PoseEstimate last;
  double stamp = 0.0;
  drive(&localizer, 0.0, 2.0, [&](const ScanResult& result) {
    last = result.update.estimate;
    stamp = result.stamp;
  });
  expectSame(*localizer.estimateAt(stamp), last);
  for (int i = 1; i <= 10; ++i) {
    localizer.addOdometry(odometryAt(start_ + 2.0 + i * kOdometryPeriod));
  }
  double before = last.covariance.determinant();
  for (const double ahead : {0.03, 0.1, 0.2, 0.27}) {
    const PoseEstimate then = *localizer.estimateAt(stamp + ahead);
    expectNear(then.base_in_map, compose(last.base_in_map, integrate(twist_, ahead)), 1e-9, 1e-9);
    EXPECT_GT(then.covariance.determinant(), before);
    before = then.covariance.determinant();
  }
  for (const double back : {0.01, 0.5}) {
    expectNear(localizer.estimateAt(stamp - back)->base_in_map,
               compose(last.base_in_map, integrate(twist_, -back)), 1e-9, 1e-9);
  }
  EXPECT_TRUE(isFinite(localizer.estimateAt(kNan)->base_in_map));
  EXPECT_TRUE(isFinite(localizer.estimateAt(1e18)->base_in_map));
}

TEST_F(LocalizerTest, AStartHoldsAtTheNewestStamp) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  // A scan older than the start meets the particles where they were then.
  localizer.addOdometry(odometryAt(start_ + 1.1));
  localizer.initialize(startAt(truthAt(start_ + 1.1), 0.05));
  expectNear(localizer.estimateAt(start_ + 1.1)->base_in_map, truthAt(start_ + 1.1), 0.02, 0.02);
  const ScanResult result = localizer.addScan(scanAt(start_ + 1.025));
  expectNear(result.update.estimate.base_in_map, truthAt(start_ + 1.025), 0.05, 0.04);
}

TEST_F(LocalizerTest, RefusesAStartThatCannotBeAndStaysAsItWas) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 0.5);
  const PoseEstimate before = *localizer.estimateAt(start_ + 0.5);
  EXPECT_THROW(localizer.initialize(startAt({-3.0, 1.0, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({3.0, 5.5, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({1e300, 0.0, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({kNan, 0.0, 0.0})), ParameterError);
  EXPECT_THROW(localizer.initialize(startAt({1.0, 1.0, kInf})), ParameterError);
  PoseEstimate wide = startAt({1.0, 1.0, 0.0});
  wide.covariance(0, 0) = kInf;
  EXPECT_THROW(localizer.initialize(wide), ParameterError);
  expectSame(*localizer.estimateAt(start_ + 0.5), before);
}

TEST_F(LocalizerTest, StartsAnywhereOnTheMap) {
  LocalizerParameters parameters = fewBeams();
  Localizer localizer = started(parameters);
  EXPECT_TRUE(localizer.initializeGlobally());
  EXPECT_EQ(localizer.particles().size(), parameters.filter.global_particles);
  EXPECT_TRUE((localizer.particles().x > 0.0 && localizer.particles().x < room_.width).all());
  EXPECT_TRUE((localizer.particles().y > 0.0 && localizer.particles().y < room_.height).all());
  EXPECT_GT(localizer.estimateAt(start_)->covariance(0, 0), 1.0);
}

struct Round {
  const char* name;
  bool scan_first;
  double odometry_delay;  // s, by which the jump reaches odometry later than the scans
};

class LoopingBag : public LocalizerTest, public testing::WithParamInterface<Round> {};

TEST_P(LoopingBag, KeepsThePoseAndGoesOn) {
  // The car drives a whole circle a round, so that a loop ends where it begins.
  twist_ = {1.5, 0.0, kPi / 2};
  const double seconds = 4.0;
  Localizer localizer = started();
  drive(&localizer, 0.0, seconds);
  for (int round = 0; round < 3; ++round) {
    const PoseEstimate before = *localizer.estimateAt(start_ + seconds);
    if (GetParam().scan_first) {
      EXPECT_EQ(localizer.addScan(scanAt(start_)).outcome, ScanOutcome::kTimeJumpedBack);
      // Scans of the new time meet odometry of the old.
      for (double late = kScanPeriod; late < GetParam().odometry_delay; late += kScanPeriod) {
        EXPECT_EQ(localizer.addScan(scanAt(start_ + late)).outcome, ScanOutcome::kUsed);
      }
    } else {
      EXPECT_EQ(localizer.addOdometry(odometryAt(start_)), OdometryOutcome::kTimeJumpedBack);
    }
    EXPECT_EQ(localizer.counters().time_jumps, static_cast<std::uint64_t>(round) + 1);
    EXPECT_LT(distance(localizer.estimateAt(start_)->base_in_map, before.base_in_map), 0.2);
    double worst = 0.0;
    drive(&localizer, GetParam().odometry_delay, seconds, [&](const ScanResult& result) {
      EXPECT_EQ(result.outcome, ScanOutcome::kUsed);
      if (result.stamp < start_ + 1.0) return;
      worst = std::max(worst, distance(result.update.estimate.base_in_map, truthAt(result.stamp)));
    });
    EXPECT_LT(worst, 0.08);
  }
}

INSTANTIATE_TEST_SUITE_P(Jumps, LoopingBag,
                         testing::Values(Round{"odometry_first", false, 0.0},
                                         Round{"scan_first", true, 0.0},
                                         Round{"odometry_late", true, 0.1}),
                         [](const auto& instance) { return instance.param.name; });

TEST_F(LocalizerTest, OneScanFromTheFutureCostsOneScan) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  EXPECT_EQ(localizer.addScan(scanAt(start_ + 1e9)).outcome, ScanOutcome::kUsed);
  EXPECT_EQ(localizer.addScan(scanAt(start_ + 1.025)).outcome, ScanOutcome::kTimeJumpedBack);
  drive(&localizer, 1.025, 3.0,
        [&](const ScanResult& result) { EXPECT_EQ(result.outcome, ScanOutcome::kUsed); });
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.06, 0.03);
}

TEST_F(LocalizerTest, CorrectsForTheMotionDuringASweep) {
  // 7 m/s and 3 rad/s round a hall, with a Hokuyo's 19 ms sweep.
  room_ = {14.0, 10.0};
  twist_ = {7.0, 0.0, 3.0};
  start_pose_ = {7.0, 2.7, 0.0};
  sweep_.seconds = 0.019;
  // The mean of the error as the car sees it: chance cancels out, a bent sweep does not.
  const auto bias = [&](bool deskewed) {
    LocalizerParameters parameters = fewBeams();
    parameters.deskew = deskewed;
    parameters.sensor.beam.table.sigma_hit = 2.0;
    Localizer localizer = started(parameters);
    Eigen::Vector2d sum(0.0, 0.0);
    int count = 0;
    drive(&localizer, 0.0, 5.0, [&](const ScanResult& result) {
      if (result.stamp < start_ + 1.0) return;
      const Pose2 error = between(truthAt(result.stamp), result.update.estimate.base_in_map);
      sum += Eigen::Vector2d(error.x, error.y);
      ++count;
    });
    return sum.norm() / count;
  };
  EXPECT_LT(bias(true), 0.01);
  EXPECT_GT(bias(false), 0.02);
}

TEST_F(LocalizerTest, FollowsPosesAsWellAsTwists) {
  LocalizerParameters parameters = fewBeams();
  parameters.odometry.motion_from = MotionFrom::kPose;
  Localizer localizer(parameters, 1);
  localizer.setMap(map(parameters));
  const Pose2 odom_in_map{20.0, -7.0, 2.0};
  for (int i = 0; i <= 150; ++i) {
    const double stamp = start_ + i * kOdometryPeriod;
    localizer.addOdometry({stamp, {kNan, kNan, kNan}, between(odom_in_map, truthAt(stamp))});
    if (i == 0) localizer.initialize(startAt(start_pose_));
    if (i > 0) localizer.addScan(scanAt(stamp - 0.007));
  }
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.05, 0.03);
  EXPECT_NEAR(localizer.twist().vx, twist_.vx, 1e-6);
}

TEST_F(LocalizerTest, KnowsHowFarOdometryReaches) {
  Localizer localizer(fewBeams(), 1);
  EXPECT_FALSE(localizer.odometryCovers(start_));
  EXPECT_EQ(localizer.twist().vx, 0.0);
  localizer.addOdometry(odometryAt(start_));
  EXPECT_TRUE(localizer.odometryCovers(start_));
  EXPECT_FALSE(localizer.odometryCovers(start_ + 0.001));
  EXPECT_EQ(*localizer.newestStamp(), start_);
  EXPECT_EQ(localizer.twist().vx, twist_.vx);
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
