#include "racecar_mcl/filter/particle_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/scan/beam_selection.h"
#include "support/particle_filter_fixture.h"

namespace racecar_mcl {
namespace {

TEST(ParticleFilter, AGlobalSetShrinksAsItConcentrates) {
  BeamModelParameters sharp = beamModel();
  sharp.likelihood_exponent = 2.0;
  MapUser map = room(sharp);
  ParticleFilter filter(sized(100, 1.0), constantNoise(0.01), 48);
  map.initializeGlobally(&filter);
  const Scan scan = scanFrom(map.map(), kTruth);
  Eigen::Index before = filter.particles().size();
  for (int i = 0; i < 20; ++i) {
    map.update(&filter, scan);
    EXPECT_LE(filter.particles().size(), before);
    before = filter.particles().size();
    filter.predict({{}, 0.5, 0.0, 0.0, 1.0});  // half a metre driven on a circle
  }
  EXPECT_LT(before, 1000);
  EXPECT_GE(before, 100);
}

TEST(ParticleFilter, KeepsItsWeightsIfAllLikelihoodsAreZero) {
  BeamModelParameters never_far = beamModel();
  never_far.table = {0.0, 0.9, 0.1, 0.0, 2.0, 101};  // no range beyond the expected one
  MapUser map = room(never_far);
  ParticleFilter filter(sized(100, 1.0), {}, 48);
  filter.initialize(startAt(kTruth, {0.1, 0.1, 0.1}));
  const ParticleSet before = filter.particles();
  Scan scan = scanFrom(map.map(), kTruth);
  scan.ranges.setConstant(8.0f);
  const UpdateResult result = map.update(&filter, scan);
  EXPECT_TRUE(result.weights_vanished);
  EXPECT_FALSE(result.resampled);
  EXPECT_TRUE((filter.particles().log_weight == before.log_weight).all());
  EXPECT_TRUE((filter.particles().x == before.x).all());
  EXPECT_TRUE(isFinite(result.estimate.base_in_map));
  EXPECT_TRUE(result.estimate.covariance.allFinite());
  EXPECT_NEAR(result.effective_sample_size, 100.0, 1e-6);
  // The next possible scan is used.
  scan.ranges.setConstant(0.01f);
  EXPECT_FALSE(map.update(&filter, scan).weights_vanished);
}

TEST(ParticleFilter, IsUnchangedByAScanWithoutBeams) {
  for (const SensorModelType model : {SensorModelType::kBeam, SensorModelType::kLikelihoodField}) {
    SensorParameters parameters = sensor(beamModel());
    parameters.sensor_model = model;
    for (const char* caster : {"bresenham", "distance_transform", "simd", "lut"}) {
      parameters.caster.range_method = caster;
      MapUser map = roomWith(parameters);
      ParticleFilter filter(sized(100, 0.5), {}, 53);
      filter.initialize(startAt(kTruth, {0.1, 0.1, 0.1}));
      const UpdateResult& result =
          map.update(&filter, selectBeams(scanFrom(map.map(), kTruth), 0, 6.0));
      EXPECT_EQ(result.beams, 0);
      EXPECT_FALSE(result.weights_vanished);
      EXPECT_NEAR(result.effective_sample_size, 100.0, 1e-9);
    }
  }
}

TEST(ParticleFilter, ReportsTheUpdate) {
  MapUser map = room();
  ParticleFilter filter(sized(300, 1.0), {}, 49);
  filter.initialize(startAt(kTruth, {0.2, 0.2, 0.2}));
  const UpdateResult result = map.update(&filter, scanFrom(map.map(), kTruth));
  EXPECT_EQ(result.beams, 10);
  EXPECT_EQ(result.particles, 300);
  EXPECT_TRUE(result.resampled);
  EXPECT_FALSE(result.weights_vanished);
  EXPECT_LT(result.log_likelihood, 0.0);
  EXPECT_GT(result.effective_sample_size, 1.0);
  EXPECT_LT(result.effective_sample_size, 300.0);
  // Resampled to uniform weights.
  EXPECT_NEAR(filter.particles().log_weight.maxCoeff(), filter.particles().log_weight.minCoeff(),
              1e-12);
}

TEST(ParticleFilter, ACorrelatedScanIsDownWeighted) {
  MapUser map = room();
  const Scan scan = scanFrom(map.map(), kTruth);
  /// Log odds of the best particle against the worst after a second scan 0.1 m later.
  const auto oddsOfSecondScan = [&](double repeat_distance, int regularization_updates) {
    ParticleFilterParameters parameters = sized(50, 1.0);
    parameters.resample_threshold = 0.01;
    parameters.min_effective_particles = 0;
    parameters.regularization_updates = regularization_updates;
    MotionModelParameters still;
    still.deterministic = true;
    ParticleFilter filter(parameters, still, 57);
    filter.initialize(startAt(kTruth, {0.02, 0.02, 0.02}));
    map.update(&filter, scan, repeat_distance);
    const Eigen::ArrayXd before = filter.particles().log_weight;
    filter.predict({{}, 0.1, 0.0, 0.0, 1.0});  // there and back
    EXPECT_FALSE(map.update(&filter, scan, repeat_distance).resampled);
    const Eigen::ArrayXd told = filter.particles().log_weight - before;
    return told.maxCoeff() - told.minCoeff();
  };
  const double whole = oddsOfSecondScan(0.0, 0);
  EXPECT_GT(whole, 0.1);
  EXPECT_NEAR(oddsOfSecondScan(0.1, 0), whole, 1e-9);
  EXPECT_NEAR(oddsOfSecondScan(0.4, 0), 0.25 * whole, 1e-9);
  EXPECT_NEAR(oddsOfSecondScan(0.4, 1), 0.25 * whole, 1e-9);
  EXPECT_NEAR(oddsOfSecondScan(0.4, 2), whole, 1e-9) << "regularization is not finished";
}

TEST(ParticleFilter, ResamplesByTheThreshold) {
  MapUser map = room();
  const Scan scan = scanFrom(map.map(), kTruth);
  const auto resampled = [&](double threshold) {
    ParticleFilter filter(sized(300, threshold), {}, 50);
    filter.initialize(startAt(kTruth, {0.2, 0.2, 0.2}));
    return map.update(&filter, scan).resampled;
  };
  EXPECT_TRUE(resampled(1.0));
  EXPECT_FALSE(resampled(0.0));
  // With a threshold of 1 a set of equal weights is resampled too.
  ParticleFilter alike(sized(200, 1.0), {}, 51);
  alike.initialize(startAt(kTruth, {1e-9, 1e-9, 1e-9}));
  EXPECT_TRUE(map.update(&alike, scan).resampled);
}

TEST(ParticleFilter, RegularizationJittersCopiesAndThenStops) {
  MapUser map = room();
  const Scan scan = scanFrom(map.map(), kTruth);
  ParticleFilterParameters parameters = sized(200, 1.0);
  parameters.regularization_updates = 2;
  ParticleFilter filter(parameters, {}, 52);
  filter.initialize(startAt(kTruth, {0.3, 0.3, 0.3}));
  const auto copies = [&] {
    std::vector<double> x(filter.particles().x.data(), filter.particles().x.data() + 200);
    std::sort(x.begin(), x.end());
    return x.end() - std::unique(x.begin(), x.end());
  };
  map.update(&filter, scan);
  EXPECT_EQ(copies(), 0);
  map.update(&filter, scan);
  EXPECT_EQ(copies(), 0);
  map.update(&filter, scan);
  EXPECT_GT(copies(), 0);
}

TEST(ParticleFilter, OneSeedGivesOneResult) {
  MapUser map = room();
  const Scan scan = scanFrom(map.map(), kTruth);
  const auto run = [&](std::uint64_t seed) {
    ParticleFilterParameters parameters = sized(333, 0.9);
    parameters.regularization_updates = 3;
    ParticleFilter filter(parameters, {}, seed);
    map.initializeGlobally(&filter);
    for (int i = 0; i < 5; ++i) {
      filter.predict({{0.02, 0.0, 0.01}, 0.02, 0.01, 0.02, 1.0});
      map.update(&filter, scan);
    }
    return filter.particles();
  };
  const ParticleSet a = run(1), b = run(1), c = run(2);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE((a.x == b.x && a.y == b.y && a.yaw == b.yaw && a.log_weight == b.log_weight).all());
  EXPECT_TRUE(a.size() != c.size() || (a.x != c.x).any());
}

TEST(ParticleFilter, AScanBeforeConvergenceIsDownWeightedByTheDistanceDriven) {
  MapUser map = room();
  const Scan scan = selectBeams(scanFrom(map.map(), kTruth), 2, 6.0);
  /// Log odds of the best particle against the worst after a scan 0.1 m from the start.
  const auto odds = [&](double decorrelation_distance) {
    ParticleFilterParameters parameters = sized(50, 0.0);
    parameters.max_particles = 50;
    parameters.scan_decorrelation_distance = decorrelation_distance;
    MotionModelParameters still;
    still.deterministic = true;
    ParticleFilter filter(parameters, still, 57);
    map.initializeGlobally(&filter);
    filter.predict({{}, 0.1, 0.0, 0.0, 1.0});
    map.update(&filter, scan);
    const Eigen::ArrayXd& weights = filter.particles().log_weight;
    return weights.maxCoeff() - weights.minCoeff();
  };
  EXPECT_GT(odds(0.1), 0.1);
  EXPECT_NEAR(odds(0.4), 0.25 * odds(0.1), 1e-9);
  EXPECT_NEAR(odds(2.0), 0.05 * odds(0.1), 1e-9);
}

TEST(ParticleFilter, AScanWithManyOutliersIsDownWeightedIfWanted) {
  MapUser map = room();
  Scan scan = scanFrom(map.map(), kTruth);
  scan.ranges.head(5) *= 0.4f;
  const auto oddsWith = [&](bool bound_information) {
    ParticleFilterParameters parameters = sized(50, 0.0);
    parameters.bound_information = bound_information;
    ParticleFilter filter(parameters, {}, 57);
    filter.initialize(startAt(kTruth, {0.02, 0.02, 0.02}));
    map.update(&filter, scan);
    const Eigen::ArrayXd& weights = filter.particles().log_weight;
    return weights.maxCoeff() - weights.minCoeff();
  };
  EXPECT_GT(oddsWith(false), 0.1);
  EXPECT_LT(oddsWith(true), 0.5 * oddsWith(false));
}

TEST(ParticleFilter, TheEstimateIsOfTheWantedKind) {
  MapUser map = room();
  const auto isAParticle = [&](EstimateFrom kind) {
    ParticleFilterParameters parameters = sized(50, 0.0);
    parameters.estimate = kind;
    ParticleFilter filter(parameters, {}, 58);
    filter.initialize(startAt(kTruth, {0.1, 0.1, 0.1}));
    const double x = map.update(&filter, scanFrom(map.map(), kTruth)).estimate.base_in_map.x;
    return (filter.particles().x == x).any();
  };
  EXPECT_TRUE(isAParticle(EstimateFrom::kBest));
  EXPECT_FALSE(isAParticle(EstimateFrom::kMean));
}

TEST(ParticleFilter, ChangedMotionParametersApplyToTheNextMotion) {
  MotionModelParameters motion;
  motion.deterministic = true;
  ParticleFilter filter(sized(50, 0.5), motion, 59);
  filter.initialize(startAt(kTruth, {1e-9, 1e-9, 1e-9}));
  const auto spreadAfterAMotion = [&] {
    filter.predict({{0.5, 0.0, 0.0}, 0.5, 0.0, 0.1, 1.0});
    return filter.particles().x.maxCoeff() - filter.particles().x.minCoeff();
  };
  EXPECT_LT(spreadAfterAMotion(), 1e-6);
  filter.setParameters(sized(50, 0.5), {});
  EXPECT_GT(spreadAfterAMotion(), 1e-3);
}

TEST(ParticleFilterParameters, RejectValuesOutOfRange) {
  const auto changed = [](const auto& change) {
    ParticleFilterParameters parameters;
    change(parameters);
    return parameters;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using P = ParticleFilterParameters;
  const P bad[] = {changed([](P& p) { p.num_particles = 0; }),
                   changed([](P& p) { p.num_particles = -200; }),
                   changed([](P& p) { p.num_particles = 2000000000; }),
                   changed([](P& p) { p.max_particles = p.num_particles - 1; }),
                   changed([](P& p) { p.resample_threshold = -0.1; }),
                   changed([](P& p) { p.resample_threshold = 1.1; }),
                   changed([&](P& p) { p.resample_threshold = nan; }),
                   changed([](P& p) { p.initial_sigma = 0.0; }),
                   changed([&](P& p) { p.initial_sigma = nan; }),
                   changed([](P& p) { p.initial_sigma = 1e300; }),
                   changed([](P& p) { p.regularization_updates = -1; })};
  EXPECT_NO_THROW(validate(P{}));
  for (const P& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(ParticleFilter(parameters, {}, 1), ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
