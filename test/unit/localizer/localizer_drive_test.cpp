#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

struct Models {
  SensorModelType sensor;
  MotionNoise motion;
};

class FollowingModels : public LocalizerTest, public testing::WithParamInterface<Models> {};

TEST_P(FollowingModels, FollowTheCar) {
  LocalizerParameters parameters = fewBeams();
  parameters.sensor.sensor_model = GetParam().sensor;
  parameters.motion.motion_model = GetParam().motion;
  parameters.sensor.beam.table.sigma_hit = 2.0;
  parameters.sensor.field = {0.05, 0.05, 30.0, 0.5, 1.0};
  parameters.effective_beams = 20.0;
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
    testing::Values(Models{SensorModelType::kBeam, MotionNoise::kConstant},
                    Models{SensorModelType::kBeam, MotionNoise::kDifferential},
                    Models{SensorModelType::kBeam, MotionNoise::kAckermann},
                    Models{SensorModelType::kLikelihoodField, MotionNoise::kConstant},
                    Models{SensorModelType::kLikelihoodField, MotionNoise::kDifferential},
                    Models{SensorModelType::kLikelihoodField, MotionNoise::kAckermann}));

TEST_F(LocalizerTest, FollowsTheCarWithDefaults) {
  Localizer localizer = started(LocalizerParameters{});
  drive(&localizer, 0.0, 4.0);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, truthAt(start_ + 4.0), 0.08, 0.05);
  const Localizability& localizability = localizer.status().localizability;
  for (const double sigma : {localizability.along, localizability.across, localizability.heading}) {
    EXPECT_GT(sigma, 1e-4);
    EXPECT_LT(sigma, 0.3);
  }
}

TEST_F(LocalizerTest, ChoosesBeamsByTheLayout) {
  LocalizerParameters parameters = fewBeams();
  const Scan scan = scanAt(start_);
  parameters.scan.beam_layout = BeamLayout::kEven;
  const Scan even = ScanPreprocessor(parameters.scan).select(scan);
  parameters.scan.beam_layout = BeamLayout::kBoxed;
  const Scan boxed = ScanPreprocessor(parameters.scan).select(scan);
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

TEST_F(LocalizerTest, TheDecorrelationDistanceGrowsOnAnIncompleteMap) {
  LocalizerParameters parameters = fewBeams();
  const auto driveWhereTheMapLacksSomething = [&](Localizer* localizer) {
    for (int i = 1; i <= 1200; ++i) {  // 36 m
      const double stamp = start_ + i * kOdometryPeriod;
      localizer->addOdometry(odometryAt(stamp));
      Scan scan = scanAt(stamp);
      // 15 % see it.
      scan.ranges.segment(70, 27) = scan.ranges.segment(70, 27).min(0.7f);
      localizer->update(scan);
    }
  };
  Localizer localizer = started(parameters);
  EXPECT_EQ(localizer.decorrelationDistance(), 0.15);
  driveWhereTheMapLacksSomething(&localizer);
  EXPECT_NEAR(localizer.status().baseline_inlier_ratio, 0.82, 0.05);
  EXPECT_NEAR(localizer.decorrelationDistance(),
              0.15 + 1.5 * parameters.filter.scan_decorrelation_distance *
                         (0.95 - localizer.status().baseline_inlier_ratio),
              1e-3);

  parameters.filter.scan_decorrelation_distance = 0.0;
  Localizer trusting = started(parameters);
  driveWhereTheMapLacksSomething(&trusting);
  EXPECT_LT(trusting.status().baseline_inlier_ratio, 0.9);
  EXPECT_EQ(trusting.decorrelationDistance(), 0.0);
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

TEST_F(LocalizerTest, CorrectsForTheMotionDuringASweep) {
  // 7 m/s and 3 rad/s round a hall, with a Hokuyo's 19 ms sweep.
  room_ = {14.0, 10.0};
  twist_ = {7.0, 0.0, 3.0};
  start_pose_ = {7.0, 2.7, 0.0};
  sweep_.seconds = 0.019;
  // The mean error in the car's frame: noise cancels out, the distortion of sweeps does not.
  const auto bias = [&](bool deskewed) {
    LocalizerParameters parameters = fewBeams();
    parameters.scan.deskew = deskewed;
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

/// A sensor model that throws on request.
class FailingCaster : public RangeCaster {
 public:
  FailingCaster(const OccupancyGrid& grid, const bool* fails)
      : RangeCaster(30.0), caster_(makeRangeCaster(grid, {"simd", 30.0})), fails_(fails) {}

  void cast(const PoseBatch& lidar_in_map, const Eigen::ArrayXf& bearings,
            Eigen::Ref<Eigen::ArrayXXf> ranges) const override {
    if (*fails_) throw std::runtime_error("the caster fails");
    caster_->cast(lidar_in_map, bearings, ranges);
  }
  std::size_t memoryBytes() const override { return caster_->memoryBytes(); }

 private:
  std::unique_ptr<RangeCaster> caster_;
  const bool* fails_;
};

TEST_F(LocalizerTest, AnInternalErrorCostsOneScan) {
  LocalizerParameters parameters = fewBeams();
  Localizer localizer = started(parameters);
  const OccupancyGrid grid = room_.grid();
  bool fails = false;
  localizer.setMap(std::make_shared<const LocalizationMap>(
      LocalizationMap{grid, std::make_unique<FailingCaster>(grid, &fails), std::nullopt,
                      GlobalScanMatcher(grid, {}), freeCells(grid)}));
  drive(&localizer, 0.0, 2.0);
  const PoseEstimate before = *localizer.estimateAt(start_ + 2.0);
  localizer.addOdometry(odometryAt(start_ + 2.02));
  localizer.addOdometry(odometryAt(start_ + 2.04));
  fails = true;
  EXPECT_THROW(localizer.update(scanAt(start_ + 2.03)), std::runtime_error);
  fails = false;
  EXPECT_EQ(localizer.counters().scans_failed, 1u);
  expectSame(*localizer.estimateAt(start_ + 2.0), before);
  const PoseEstimate of_particles = estimatePose(localizer.particles(), EstimateFrom::kMean);
  expectNear(of_particles.base_in_map, before.base_in_map, 0.03, 0.03);
  const ScanResult next = localizer.update(scanAt(start_ + 2.04));
  EXPECT_EQ(next.outcome, ScanOutcome::kUsed);
  expectNear(next.update.estimate.base_in_map, truthAt(start_ + 2.04), 0.06, 0.04);
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
    if (i > 0) localizer.update(scanAt(stamp - 0.007));
  }
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.05, 0.03);
  EXPECT_NEAR(localizer.twist().vx, twist_.vx, 1e-6);
}

TEST_F(LocalizerTest, ReportsTheDisagreementOfScansAndOdometry) {
  const auto disagreementWith = [&](double scale) {
    Localizer localizer = started();
    for (int i = 1; i <= 80; ++i) {
      const double stamp = start_ + i * kScanPeriod;
      localizer.addOdometry({stamp, {scale * twist_.vx, 0.0, twist_.wz}, {}});
      localizer.update(scanAt(stamp));
    }
    return localizer.status().disagreement;
  };
  EXPECT_LT(disagreementWith(1.0), 0.05);
  EXPECT_GT(disagreementWith(0.8), 0.1);
}

TEST_F(LocalizerTest, TheCovarianceIncludesTheErrorOfTheSurfaces) {
  LocalizerParameters parameters = fewBeams();
  parameters.motion.deterministic = true;
  parameters.filter.regularization_updates = 0;
  Localizer localizer(parameters, 1);
  localizer.setMap(map(parameters));
  localizer.addOdometry(odometryAt(start_));
  localizer.initialize(startAt(start_pose_, 0.0));
  drive(&localizer, 0.0, 1.0);
  const Eigen::Matrix3d covariance = localizer.estimateAt(start_ + 1.0)->covariance;
  const double sigma = 0.1 * localizer.map()->grid.geometry().resolution;
  EXPECT_NEAR(covariance(0, 0), sigma * sigma, 1e-7);
  EXPECT_NEAR(covariance(1, 1), sigma * sigma, 1e-7);
}

}  // namespace
}  // namespace racecar_mcl
