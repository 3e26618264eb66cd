#include "racecar_mcl/particle_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "racecar_mcl/errors.h"
#include "support/ascii_map.h"
#include "support/statistics.h"

namespace racecar_mcl {
namespace {

// 3 x 1.6 m with an alcove and a pillar, so that no two places look alike.
const char* const kRoom = R"(
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

BeamModelParameters beamModel() {
  BeamModelParameters parameters;
  parameters.table = {0.74, 0.07, 0.07, 0.12, 2.0, 101};
  parameters.squash_factor = 2.2;
  return parameters;
}

SensorParameters sensor(const BeamModelParameters& beam, double max_range = 0.0) {
  SensorParameters parameters;
  parameters.sensor_model = SensorModel::kBeam;
  parameters.caster = {"bresenham", max_range, UnknownIs::kFree};
  parameters.beam = beam;
  return parameters;
}

std::shared_ptr<MapModel> room(const BeamModelParameters& beam = beamModel()) {
  return makeMapModel(asciiMap(kRoom, 0.1, {-1.0, 0.5, 0.2}), sensor(beam));
}

// The car in the middle of the room, whose grid is turned by 0.2 rad.
const Pose2 kTruth{0.4, 1.6, 0.7};

Scan scanFrom(const MapModel& map, const Pose2& base_in_map) {
  Scan scan;
  scan.laser_in_base = {0.1, 0.02, 0.05};
  scan.bearings = Eigen::ArrayXf::LinSpaced(10, -2.3f, 2.3f);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(10);
  const Pose2 lidar = compose(base_in_map, scan.laser_in_base);
  Eigen::ArrayXXf ranges(10, 1);
  map.caster->cast({&lidar.x, &lidar.y, &lidar.yaw, 1}, scan.bearings, ranges);
  // Off by what a lidar is off, so that the truth is not the likeliest pose.
  for (Eigen::Index k = 0; k < 10; ++k) {
    ranges(k, 0) += 0.08f * std::sin(3.0f * static_cast<float>(k));
  }
  scan.ranges = ranges.col(0);
  return scan;
}

ParticleFilterParameters sized(int count, double threshold) {
  ParticleFilterParameters parameters;
  parameters.num_particles = count;
  parameters.global_particles = std::max(count, 20000);
  parameters.resample_threshold = threshold;
  parameters.estimate = EstimateFrom::kMean;
  parameters.settling_updates = 0;
  parameters.min_effective_particles = 0;
  return parameters;
}

MotionModelParameters constantNoise(double position_sigma) {
  MotionModelParameters parameters;
  parameters.motion_model = MotionNoise::kConstant;
  parameters.constant_x_sigma = parameters.constant_y_sigma = position_sigma;
  parameters.constant_yaw_sigma = 0.0;
  return parameters;
}

PoseEstimate startAt(const Pose2& pose, const Eigen::Vector3d& sigma) {
  return {pose, Eigen::Matrix3d(sigma.array().square().matrix().asDiagonal())};
}

/// A posterior by numerical integration: a weight for every pose of a regular grid.
class GridPosterior {
 public:
  /// A Gaussian prior about `centre`, on (2 n + 1) values per axis out to four sigmas. An axis with
  /// sigma 0 has one value.
  GridPosterior(const Pose2& centre, const Eigen::Vector3d& sigma, int n, double reach = 4.0) {
    for (int axis = 0; axis < 3; ++axis) {
      count_[axis] = sigma[axis] > 0.0 ? 2 * n + 1 : 1;
      step_[axis] = reach * sigma[axis] / n;
    }
    const double middle[] = {centre.x, centre.y, centre.yaw};
    const auto value = [&](int axis, int index) {
      return middle[axis] + step_[axis] * (index - (count_[axis] - 1) / 2);
    };
    set_.resize(static_cast<Eigen::Index>(count_[0]) * count_[1] * count_[2]);
    Eigen::Index i = 0;
    for (int yaw = 0; yaw < count_[2]; ++yaw) {
      for (int y = 0; y < count_[1]; ++y) {
        for (int x = 0; x < count_[0]; ++x, ++i) {
          set_.setPose(i, {value(0, x), value(1, y), value(2, yaw)});
          double squares = 0.0;
          const int index[] = {x, y, yaw};
          for (int axis = 0; axis < 3; ++axis) {
            if (sigma[axis] == 0.0) continue;
            squares += std::pow((value(axis, index[axis]) - middle[axis]) / sigma[axis], 2);
          }
          set_.log_weight[i] = -0.5 * squares;
        }
      }
    }
    normalizeLogWeights(&set_.log_weight);
  }

  /// Bayes' rule at every grid pose.
  void update(const MapModel& map, const Scan& scan) {
    ParticleSet lidars = set_;
    for (Eigen::Index i = 0; i < set_.size(); ++i) {
      lidars.setPose(i, compose(set_.pose(i), scan.laser_in_base));
    }
    Eigen::ArrayXd log_likelihoods(set_.size());
    if (map.likelihood_field) {
      map.likelihood_field->logLikelihood(lidars.poses(), scan, log_likelihoods);
    } else {
      Eigen::ArrayXXf ranges(scan.size(), set_.size());
      map.caster->cast(lidars.poses(), scan.bearings, ranges);
      map.beam_model.logLikelihood(scan.ranges, ranges, log_likelihoods);
    }
    set_.log_weight += log_likelihoods;
    normalizeLogWeights(&set_.log_weight);
  }

  /// Moves all poses alike, which is exact where all have one yaw, then blurs by a Gaussian.
  void predict(const Pose2& delta, double position_sigma) {
    for (Eigen::Index i = 0; i < set_.size(); ++i) {
      set_.setPose(i, compose(set_.pose(i), delta));
    }
    const Eigen::Map<Eigen::MatrixXd> weights(set_.log_weight.data(), count_[0], count_[1]);
    const Eigen::MatrixXd blurred = kernel(0, position_sigma) * weights.array().exp().matrix() *
                                    kernel(1, position_sigma).transpose();
    set_.log_weight = Eigen::Map<const Eigen::ArrayXd>(blurred.data(), blurred.size()).log();
    normalizeLogWeights(&set_.log_weight);
  }

  PoseEstimate estimate() const { return weightedMean(set_); }

 private:
  Eigen::MatrixXd kernel(int axis, double sigma) const {
    Eigen::MatrixXd matrix(count_[axis], count_[axis]);
    for (int i = 0; i < count_[axis]; ++i) {
      for (int j = 0; j < count_[axis]; ++j) {
        matrix(i, j) = std::exp(-0.5 * std::pow((i - j) * step_[axis] / sigma, 2));
      }
    }
    return matrix;
  }

  int count_[3];
  double step_[3];
  ParticleSet set_;
};

/// The estimate within what sampling allows: means by a share of the spread, spreads by a ratio.
void expectAgrees(const PoseEstimate& measured, const PoseEstimate& expected, double tolerance) {
  const Eigen::Vector3d off(measured.base_in_map.x - expected.base_in_map.x,
                            measured.base_in_map.y - expected.base_in_map.y,
                            wrapAngle(measured.base_in_map.yaw - expected.base_in_map.yaw));
  for (int i = 0; i < 3; ++i) {
    const double spread = std::sqrt(expected.covariance(i, i));
    EXPECT_NEAR(off[i], 0.0, tolerance * spread + 1e-4) << "mean " << i;
    EXPECT_NEAR(std::sqrt(measured.covariance(i, i)), spread, tolerance * spread + 1e-4)
        << "spread " << i;
  }
}

class OneScan : public testing::TestWithParam<SensorModel> {};

TEST_P(OneScan, GivesTheIntegratedPosterior) {
  SensorParameters parameters = sensor(beamModel());
  parameters.sensor_model = GetParam();
  parameters.field = {0.2, 0.1, 30.0, 1.0, 0.5};
  const std::shared_ptr<MapModel> map = makeMapModel(room()->grid, parameters);
  const Scan scan = scanFrom(*map, kTruth);
  const Pose2 guess{kTruth.x + 0.1, kTruth.y - 0.05, kTruth.yaw - 0.08};
  const Eigen::Vector3d sigma(0.15, 0.12, 0.15);
  GridPosterior posterior(guess, sigma, 20);
  posterior.update(*map, scan);

  ParticleFilter filter(sized(40000, 0.0), {}, 41);
  filter.initialize(startAt(guess, sigma));
  const UpdateResult result = filter.update(map.get(), scan);
  expectAgrees(result.estimate, posterior.estimate(), 0.04);
  // And the scan has told something, or the comparison shows nothing.
  EXPECT_LT(posterior.estimate().covariance(0, 0), 0.6 * sigma[0] * sigma[0]);
  EXPECT_LT(posterior.estimate().covariance(2, 2), 0.6 * sigma[2] * sigma[2]);
}

INSTANTIATE_TEST_SUITE_P(SensorModels, OneScan,
                         testing::Values(SensorModel::kBeam, SensorModel::kLikelihoodField));

struct Resampled {
  double threshold;
  ResamplingMethod method;
};

class FilteredDrive : public testing::TestWithParam<Resampled> {};

TEST_P(FilteredDrive, GivesTheIntegratedPosterior) {
  const std::shared_ptr<MapModel> map = room();
  const Pose2 delta{0.25, 0.05, 0.3};
  const double noise = 0.04;
  const Pose2 guess{kTruth.x - 0.08, kTruth.y + 0.1, kTruth.yaw};
  const Eigen::Vector3d sigma(0.2, 0.2, 0.0);
  GridPosterior posterior(guess, sigma, 60);
  ParticleFilterParameters parameters = sized(20000, GetParam().threshold);
  parameters.resampling = GetParam().method;
  ParticleFilter filter(parameters, constantNoise(noise), 42);
  filter.initialize(startAt(guess, {0.2, 0.2, 1e-6}));

  Pose2 truth = kTruth;
  for (int step = 0; step < 3; ++step) {
    const Scan scan = scanFrom(*map, truth);
    posterior.update(*map, scan);
    const UpdateResult result = filter.update(map.get(), scan);
    EXPECT_EQ(result.resampled, result.effective_sample_size <= GetParam().threshold * 20000);
    expectAgrees(result.estimate, posterior.estimate(), 0.06);
    truth = compose(truth, delta);
    posterior.predict(delta, noise);
    filter.predict({delta, std::hypot(delta.x, delta.y), delta.yaw, 0.1, 1.0});
    expectAgrees(filter.estimate(), posterior.estimate(), 0.06);
  }
}

INSTANTIATE_TEST_SUITE_P(Resampling, FilteredDrive,
                         testing::Values(Resampled{0.0, ResamplingMethod::kSystematic},
                                         Resampled{0.5, ResamplingMethod::kSystematic},
                                         Resampled{1.0, ResamplingMethod::kSystematic},
                                         Resampled{1.0, ResamplingMethod::kMultinomial}));

TEST(ParticleFilter, StartsAsThePoseAndItsCovarianceSay) {
  PoseEstimate start{{2.0, -1.0, 3.0}, Eigen::Matrix3d::Zero()};
  start.covariance << 0.09, 0.03, 0.0, 0.03, 0.04, 0.0, 0.0, 0.0, 1e-4;
  ParticleFilter filter(sized(20000, 0.5), {}, 43);
  EXPECT_FALSE(filter.initialized());
  filter.initialize(start);
  EXPECT_TRUE(filter.initialized());
  const SetMoments moments = momentsOf(filter.particles());
  EXPECT_NEAR(moments.mean.x(), 2.0, 0.01);
  EXPECT_NEAR(moments.mean.y(), -1.0, 0.01);
  EXPECT_NEAR(moments.mean.z(), 3.0, 0.001);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(moments.covariance(i, i), start.covariance(i, i),
                varianceTolerance(20000) * start.covariance(i, i));
  }
  EXPECT_NEAR(moments.covariance(0, 1), 0.03, 0.003);
  EXPECT_NEAR(filter.particles().log_weight.exp().sum(), 1.0, 1e-9);
}

TEST(ParticleFilter, StartsWithTheReportsSpreadWhereNoneIsGiven) {
  ParticleFilterParameters parameters = sized(20000, 0.5);
  parameters.initial_sigma = 0.5;
  ParticleFilter filter(parameters, {}, 44);
  filter.initialize({{1.0, 1.0, 0.0}, Eigen::Matrix3d::Zero()});
  const SetMoments moments = momentsOf(filter.particles());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(moments.covariance(i, i), 0.25, varianceTolerance(20000) * 0.25);
  }
}

TEST(ParticleFilter, RefusesAStartThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  ParticleFilter filter(sized(10, 0.5), {}, 45);
  filter.initialize({{1.0, 2.0, 0.5}, Eigen::Matrix3d::Zero()});
  const ParticleSet before = filter.particles();
  for (const Pose2& pose :
       {Pose2{nan, 0.0, 0.0}, Pose2{0.0, inf, 0.0}, Pose2{0.0, 0.0, nan}, Pose2{1e300, 0.0, 0.0}}) {
    EXPECT_THROW(filter.initialize({pose, Eigen::Matrix3d::Zero()}), ParameterError);
  }
  PoseEstimate start;
  for (const double bad : {nan, inf, -0.5, 1e300}) {
    start.covariance = Eigen::Matrix3d::Zero();
    start.covariance(1, 1) = bad;
    EXPECT_THROW(filter.initialize(start), ParameterError);
  }
  start.covariance << 0.01, 0.5, 0.0, 0.5, 0.01, 0.0, 0.0, 0.0, 0.01;  // correlated beyond 1
  EXPECT_THROW(filter.initialize(start), ParameterError);
  EXPECT_TRUE((filter.particles().x == before.x).all());
}

TEST(ParticleFilter, AGlobalStartCoversTheFreeSpaceEvenly) {
  const std::shared_ptr<MapModel> map = room();
  ParticleFilter filter(sized(100, 0.5), {}, 46);
  filter.initializeGlobally(*map);
  const ParticleSet& particles = filter.particles();
  ASSERT_EQ(particles.size(), 20000);
  int left_half = 0, pointing_up = 0;
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    const Cell cell = cellAt(map->grid.geometry(), {particles.x[i], particles.y[i]});
    ASSERT_TRUE(map->grid.isFree(cell));
    left_half += cell.column < 15 ? 1 : 0;
    pointing_up += particles.yaw[i] > 0.0 ? 1 : 0;
  }
  const auto free_left = std::count_if(map->free_cells.begin(), map->free_cells.end(),
                                       [](const Cell& cell) { return cell.column < 15; });
  const double share = static_cast<double>(free_left) / map->free_cells.size();
  EXPECT_NEAR(left_half / 20000.0, share, 5 * 0.5 / std::sqrt(20000.0));
  EXPECT_NEAR(pointing_up / 20000.0, 0.5, 5 * 0.5 / std::sqrt(20000.0));
}

TEST(ParticleFilter, AGlobalSetShrinksAsItConcentrates) {
  const std::shared_ptr<MapModel> map = room();
  BeamModelParameters sharp = beamModel();
  sharp.squash_factor = 0.5;
  const std::shared_ptr<MapModel> sharp_map = room(sharp);
  ParticleFilter filter(sized(100, 1.0), constantNoise(0.01), 47);
  filter.initializeGlobally(*sharp_map);
  const Scan scan = scanFrom(*sharp_map, kTruth);
  Eigen::Index before = filter.particles().size();
  for (int i = 0; i < 15; ++i) {
    filter.update(sharp_map.get(), scan);
    EXPECT_LE(filter.particles().size(), before);
    before = filter.particles().size();
    filter.predict({{}, 0.5, 0.0, 0.0, 1.0});  // as if on a circle: half a metre of news
  }
  EXPECT_LT(before, 1000);
  EXPECT_GE(before, 100);
}

TEST(ParticleFilter, KeepsItsWeightsWhereNoParticleCanHaveSeenTheScan) {
  BeamModelParameters never_far = beamModel();
  never_far.table = {0.0, 0.9, 0.1, 0.0, 2.0, 101};  // no range beyond the expected one
  const std::shared_ptr<MapModel> map = room(never_far);
  ParticleFilter filter(sized(100, 1.0), {}, 48);
  filter.initialize(startAt(kTruth, {0.1, 0.1, 0.1}));
  const ParticleSet before = filter.particles();
  Scan scan = scanFrom(*map, kTruth);
  scan.ranges.setConstant(8.0f);
  const UpdateResult result = filter.update(map.get(), scan);
  EXPECT_TRUE(result.weights_vanished);
  EXPECT_FALSE(result.resampled);
  EXPECT_TRUE((filter.particles().log_weight == before.log_weight).all());
  EXPECT_TRUE((filter.particles().x == before.x).all());
  EXPECT_TRUE(isFinite(result.estimate.base_in_map));
  EXPECT_TRUE(result.estimate.covariance.allFinite());
  EXPECT_NEAR(result.effective_sample_size, 100.0, 1e-6);
  // The next scan that can be seen is used.
  scan.ranges.setConstant(0.01f);
  EXPECT_FALSE(filter.update(map.get(), scan).weights_vanished);
}

TEST(ParticleFilter, ReportsWhatAnUpdateDid) {
  const std::shared_ptr<MapModel> map = room();
  ParticleFilter filter(sized(300, 1.0), {}, 49);
  filter.initialize(startAt(kTruth, {0.2, 0.2, 0.2}));
  const UpdateResult result = filter.update(map.get(), scanFrom(*map, kTruth));
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

TEST(ParticleFilter, ResamplesByTheThreshold) {
  const std::shared_ptr<MapModel> map = room();
  const Scan scan = scanFrom(*map, kTruth);
  const auto resampled = [&](double threshold) {
    ParticleFilter filter(sized(300, threshold), {}, 50);
    filter.initialize(startAt(kTruth, {0.2, 0.2, 0.2}));
    return filter.update(map.get(), scan).resampled;
  };
  EXPECT_TRUE(resampled(1.0));
  EXPECT_FALSE(resampled(0.0));
  // A set all alike is resampled, too, where every scan is to resample it.
  ParticleFilter alike(sized(200, 1.0), {}, 51);
  alike.initialize(startAt(kTruth, {1e-9, 1e-9, 1e-9}));
  EXPECT_TRUE(alike.update(map.get(), scan).resampled);
}

TEST(ParticleFilter, SettlingSpreadsCopiesAndThenStops) {
  const std::shared_ptr<MapModel> map = room();
  const Scan scan = scanFrom(*map, kTruth);
  ParticleFilterParameters parameters = sized(200, 1.0);
  parameters.settling_updates = 2;
  ParticleFilter filter(parameters, {}, 52);
  filter.initialize(startAt(kTruth, {0.3, 0.3, 0.3}));
  const auto copies = [&] {
    std::vector<double> x(filter.particles().x.data(), filter.particles().x.data() + 200);
    std::sort(x.begin(), x.end());
    return x.end() - std::unique(x.begin(), x.end());
  };
  filter.update(map.get(), scan);
  EXPECT_EQ(copies(), 0);
  filter.update(map.get(), scan);
  EXPECT_EQ(copies(), 0);
  filter.update(map.get(), scan);
  EXPECT_GT(copies(), 0);
}

TEST(ParticleFilter, OneSeedGivesOneResult) {
  const std::shared_ptr<MapModel> map = room();
  const Scan scan = scanFrom(*map, kTruth);
  const auto run = [&](std::uint64_t seed) {
    ParticleFilterParameters parameters = sized(333, 0.9);
    parameters.settling_updates = 3;
    ParticleFilter filter(parameters, {}, seed);
    filter.initializeGlobally(*map);
    for (int i = 0; i < 5; ++i) {
      filter.predict({{0.02, 0.0, 0.01}, 0.02, 0.01, 0.02, 1.0});
      filter.update(map.get(), scan);
    }
    return filter.particles();
  };
  const ParticleSet a = run(1), b = run(1), c = run(2);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE((a.x == b.x && a.y == b.y && a.yaw == b.yaw && a.log_weight == b.log_weight).all());
  EXPECT_TRUE(a.size() != c.size() || (a.x != c.x).any());
}

TEST(MapModel, RefusesAMapWithoutAFreeCell) {
  for (const char* drawing : {"###", "???", "#?#"}) {
    EXPECT_THROW(makeMapModel(asciiMap(drawing, 0.1), sensor(beamModel())), MapError);
  }
}

TEST(MapModel, ExpectedRangesReachAsFarAsMeasuredOnes) {
  // The table of 101 pixels reaches to 10 m.
  const auto with = [](double max_range) {
    return makeMapModel(asciiMap(kRoom, 0.1), sensor(beamModel(), max_range));
  };
  EXPECT_NO_THROW(with(0.0));
  EXPECT_NO_THROW(with(10.0));
  EXPECT_NO_THROW(with(30.0));
  EXPECT_THROW(with(5.0), ParameterError);
  EXPECT_THROW(with(-1.0), ParameterError);
  EXPECT_THROW(with(std::numeric_limits<double>::quiet_NaN()), ParameterError);
}

TEST(ParticleFilterParameters, RefuseWhatCannotBe) {
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
                   changed([](P& p) { p.global_particles = p.num_particles - 1; }),
                   changed([](P& p) { p.resample_threshold = -0.1; }),
                   changed([](P& p) { p.resample_threshold = 1.1; }),
                   changed([&](P& p) { p.resample_threshold = nan; }),
                   changed([](P& p) { p.initial_sigma = 0.0; }),
                   changed([&](P& p) { p.initial_sigma = nan; }),
                   changed([](P& p) { p.initial_sigma = 1e300; }),
                   changed([](P& p) { p.settling_updates = -1; })};
  EXPECT_NO_THROW(validate(P{}));
  for (const P& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(ParticleFilter(parameters, {}, 1), ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
