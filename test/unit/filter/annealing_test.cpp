// Annealing (min_effective_particles).
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

const char* const kRoom = R"(
    ####################
    #..................#
    #..........##......#
    #..........##......#
    #..................#
    #..................#
    ###................#
    ###................#
    ###..........#######
    ####################)";

const Pose2 kTruth{0.9, 0.55, 0.4};
const Pose2 kGuess{1.0, 0.45, 0.3};
const Eigen::Vector3d kSigma(0.2, 0.2, 0.2);

SensorParameters sensor() {
  SensorParameters parameters;
  parameters.field.field_scale = 0.05;
  parameters.field.likelihood_exponent = 1.0;
  return parameters;
}

Scan scanFromTheTruth(const LocalizationMap& map) {
  Scan scan;
  scan.bearings = Eigen::ArrayXf::LinSpaced(12, -2.3F, 2.3F);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(12);
  Eigen::ArrayXXf ranges(12, 1);
  map.caster->cast(batchOf(kTruth), scan.bearings, ranges);
  scan.ranges = ranges.col(0) + 0.05F;  // from the cell's border to its centre
  return scan;
}

class Annealing : public testing::Test {
 protected:
  ParticleFilter started(int particles, int min_effective_particles, std::uint64_t seed,
                         const MotionModelParameters& motion = {}) {
    ParticleFilterParameters parameters;
    parameters.num_particles = particles;
    parameters.max_particles = particles;
    parameters.min_effective_particles = min_effective_particles;
    parameters.resample_threshold = 0.0;
    parameters.regularization_updates = 0;
    ParticleFilter filter(parameters, motion, seed);
    filter.initialize({kGuess, kSigma.array().square().matrix().asDiagonal()});
    return filter;
  }

  UpdateResult updated(int particles, int min_effective_particles, std::uint64_t seed) {
    return started(particles, min_effective_particles, seed).update(scan_, model_.get());
  }

  const std::shared_ptr<const LocalizationMap> map_ =
      makeLocalizationMap(asciiMap(kRoom, 0.1), sensor());
  const std::unique_ptr<SensorModel> model_ = makeSensorModel(*map_, sensor());
  const Scan scan_ = scanFromTheTruth(*map_);
};

TEST_F(Annealing, LeavesEnoughEffectiveParticles) {
  ParticleFilter annealed = started(200, 50, 1);
  const UpdateResult result = annealed.update(scan_, model_.get());
  EXPECT_GE(result.effective_sample_size, 50.0);
  EXPECT_TRUE(result.resampled);
  ParticleFilter at_once = started(200, 0, 1);
  EXPECT_LT(at_once.update(scan_, model_.get()).effective_sample_size, 20.0);
}

TEST_F(Annealing, BringsFewParticlesCloserToTheEstimateOfMany) {
  const PoseEstimate posterior = updated(400000, 0, 2).estimate;
  const double spread = std::sqrt(posterior.covariance(0, 0) + posterior.covariance(1, 1));
  double squares_annealed = 0.0, squares_at_once = 0.0, variance = 0.0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    const auto seed = static_cast<std::uint64_t>(100 + run);
    const PoseEstimate annealed = updated(200, 50, seed).estimate;
    const PoseEstimate at_once = updated(200, 0, seed).estimate;
    squares_annealed += std::pow(distance(annealed.base_in_map, posterior.base_in_map), 2);
    squares_at_once += std::pow(distance(at_once.base_in_map, posterior.base_in_map), 2);
    variance += (annealed.covariance(0, 0) + annealed.covariance(1, 1)) / kRuns;
  }
  EXPECT_LT(squares_annealed, 0.5 * squares_at_once);
  EXPECT_LT(std::sqrt(squares_annealed / kRuns), 0.4 * spread);
  EXPECT_NEAR(std::sqrt(variance), spread, 0.25 * spread);
}

// Within the bias of the kernel; each of the three steps reduces the logarithm by at least two.
TEST_F(Annealing, IncludesTheLikelihoodOfEveryStep) {
  const double at_once = updated(400000, 0, 3).log_likelihood;
  double annealed = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    annealed += updated(5000, 1250, seed).log_likelihood / 20.0;
  }
  EXPECT_NEAR(annealed, at_once, 1.0);
}

TEST_F(Annealing, IsNotUsedIfEnoughParticlesAreEffective) {
  Scan scan = scan_;
  scan.ranges.setConstant(1000.0F);  // beyond field_max_range: not evaluated
  ParticleFilter filter = started(200, 50, 4);
  EXPECT_FALSE(filter.update(scan, model_.get()).resampled);
}

TEST_F(Annealing, BeginsBelowTheMinimum) {
  const double at_once = updated(200, 0, 1).effective_sample_size;
  EXPECT_FALSE(updated(200, static_cast<int>(at_once), 1).resampled);
  EXPECT_TRUE(updated(200, static_cast<int>(at_once) + 1, 1).resampled);
}

TEST_F(Annealing, GoesOnWithoutOtherResampling) {
  ParticleFilter filter = started(200, 50, 6);
  Motion motion;
  motion.distance = 0.1;
  motion.seconds = 0.1;
  for (int i = 0; i < 20; ++i) {
    filter.predict(motion);
    EXPECT_GE(filter.update(scan_, model_.get()).effective_sample_size, 20.0) << i;
  }
}

TEST_F(Annealing, IsNotUsedWithDeterministicMotion) {
  MotionModelParameters motion;
  motion.deterministic = true;
  ParticleFilter filter = started(200, 50, 5, motion);
  const Eigen::ArrayXd before = filter.particles().x;
  EXPECT_FALSE(filter.update(scan_, model_.get()).resampled);
  EXPECT_TRUE((filter.particles().x == before).all());
}

}  // namespace
}  // namespace racecar_mcl
