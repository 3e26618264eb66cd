#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/filter/particle_filter.h"
#include "support/particle_filter_fixture.h"
#include "support/statistics.h"

namespace racecar_mcl {
namespace {

TEST(ParticleFilter, StartsWithTheGivenPoseAndCovariance) {
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

TEST(ParticleFilter, ThrowsBeforeAStart) {
  MapUser map = room();
  ParticleFilter filter(sized(100, 0.5), {}, 43);
  EXPECT_NO_THROW(filter.predict({}));
  EXPECT_THROW(map.update(&filter, scanFrom(map.map(), kTruth)), std::logic_error);
  EXPECT_THROW(filter.estimate(), std::logic_error);
}

TEST(ParticleFilter, StartsWithTheInitialSigmaIfNoneIsGiven) {
  for (const double sigma : {0.5, 0.2}) {
    ParticleFilterParameters parameters = sized(20000, 0.5);
    parameters.initial_sigma = sigma;
    ParticleFilter filter(parameters, {}, 44);
    filter.initialize({{1.0, 1.0, 0.0}, Eigen::Matrix3d::Zero()});
    const SetMoments moments = momentsOf(filter.particles());
    const double variance = sigma * sigma;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(moments.covariance(i, i), variance, varianceTolerance(20000) * variance);
    }
  }
}

TEST(ParticleFilter, RejectsInvalidStarts) {
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
  start.covariance = 0.01 * Eigen::Matrix3d::Identity();
  start.covariance(0, 2) = start.covariance(2, 0) = 1e308;
  EXPECT_THROW(filter.initialize(start), ParameterError);
  start.covariance << 0.01, 0.5, 0.0, 0.5, 0.01, 0.0, 0.0, 0.0, 0.01;  // correlated beyond 1
  EXPECT_THROW(filter.initialize(start), ParameterError);
  EXPECT_TRUE((filter.particles().x == before.x).all());
}

TEST(ParticleFilter, AGlobalStartCoversTheFreeSpaceEvenly) {
  MapUser map = room();
  ParticleFilter filter(sized(100, 0.5), {}, 46);
  map.initializeGlobally(&filter);
  const ParticleSet& particles = filter.particles();
  ASSERT_EQ(particles.size(), 20000);
  EXPECT_FALSE(filter.converged());
  int left_half = 0, pointing_up = 0;
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    const Cell cell = cellAt(map.map().grid.geometry(), {particles.x[i], particles.y[i]});
    ASSERT_TRUE(map.map().grid.isFree(cell));
    left_half += cell.column < 15 ? 1 : 0;
    pointing_up += particles.yaw[i] > 0.0 ? 1 : 0;
  }
  const std::vector<Cell> free = map.map().free_cells.cells();
  const auto free_left =
      std::count_if(free.begin(), free.end(), [](const Cell& cell) { return cell.column < 15; });
  const double share = static_cast<double>(free_left) / free.size();
  EXPECT_NEAR(left_half / 20000.0, share, 5 * 0.5 / std::sqrt(20000.0));
  EXPECT_NEAR(pointing_up / 20000.0, 0.5, 5 * 0.5 / std::sqrt(20000.0));
}

TEST(ParticleFilter, AGlobalStartHasTheMaximumNumberOfParticles) {
  const MapUser map = room();
  ParticleFilterParameters parameters = sized(100, 0.5);
  parameters.max_particles = 700;
  ParticleFilter filter(parameters, {}, 46);
  map.initializeGlobally(&filter);
  EXPECT_EQ(filter.particles().size(), 700);
}

}  // namespace
}  // namespace racecar_mcl
