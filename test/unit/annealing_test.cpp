// Weighing a scan in steps (min_effective_particles).
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "racecar_mcl/particle_filter.h"
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

std::shared_ptr<MapModel> room() {
  SensorParameters parameters;
  parameters.field.field_sigma = 0.05;
  parameters.field.field_squash = 1.0;
  return makeMapModel(asciiMap(kRoom, 0.1), parameters);
}

Scan scanFromTheTruth(const MapModel& map) {
  Scan scan;
  scan.bearings = Eigen::ArrayXf::LinSpaced(12, -2.3F, 2.3F);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(12);
  Eigen::ArrayXXf ranges(12, 1);
  map.caster->cast({&kTruth.x, &kTruth.y, &kTruth.yaw, 1}, scan.bearings, ranges);
  scan.ranges = ranges.col(0) + 0.05F;  // rays end at a cell's side, the field is of its middle
  return scan;
}

class Annealing : public testing::Test {
 protected:
  ParticleFilter started(int particles, int min_effective_particles, std::uint64_t seed,
                         const MotionModelParameters& motion = {}) {
    ParticleFilterParameters parameters;
    parameters.num_particles = particles;
    parameters.global_particles = particles;
    parameters.min_effective_particles = min_effective_particles;
    parameters.resample_threshold = 0.0;
    parameters.settling_updates = 0;
    ParticleFilter filter(parameters, motion, seed);
    filter.initialize({kGuess, kSigma.array().square().matrix().asDiagonal()});
    return filter;
  }

  const std::shared_ptr<MapModel> map_ = room();
  const Scan scan_ = scanFromTheTruth(*map_);
};

TEST_F(Annealing, LeavesEnoughEffectiveParticles) {
  ParticleFilter in_steps = started(200, 80, 1);
  const UpdateResult result = in_steps.update(map_.get(), scan_);
  EXPECT_GE(result.effective_sample_size, 80.0);
  EXPECT_TRUE(result.resampled);
  ParticleFilter at_once = started(200, 0, 1);
  EXPECT_LT(at_once.update(map_.get(), scan_).effective_sample_size, 20.0);
}

TEST_F(Annealing, BringsFewParticlesCloserToWhatManySay) {
  const PoseEstimate posterior = started(400000, 0, 2).update(map_.get(), scan_).estimate;
  const double spread = std::sqrt(posterior.covariance(0, 0) + posterior.covariance(1, 1));
  double squares_in_steps = 0.0, squares_at_once = 0.0, variance = 0.0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    const auto seed = static_cast<std::uint64_t>(100 + run);
    const PoseEstimate in_steps = started(200, 100, seed).update(map_.get(), scan_).estimate;
    const PoseEstimate at_once = started(200, 0, seed).update(map_.get(), scan_).estimate;
    squares_in_steps += std::pow(distance(in_steps.base_in_map, posterior.base_in_map), 2);
    squares_at_once += std::pow(distance(at_once.base_in_map, posterior.base_in_map), 2);
    variance += (in_steps.covariance(0, 0) + in_steps.covariance(1, 1)) / kRuns;
  }
  EXPECT_LT(squares_in_steps, 0.5 * squares_at_once);
  EXPECT_LT(std::sqrt(squares_in_steps / kRuns), 0.4 * spread);
  EXPECT_NEAR(std::sqrt(variance), spread, 0.25 * spread);
}

// Up to what the kernel blurs: each of the three parts takes two or more off the logarithm.
TEST_F(Annealing, CountsTheLikelihoodOfEveryPart) {
  const double at_once = started(400000, 0, 3).update(map_.get(), scan_).log_likelihood;
  double in_steps = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    in_steps += started(5000, 2500, seed).update(map_.get(), scan_).log_likelihood / 20.0;
  }
  EXPECT_NEAR(in_steps, at_once, 1.0);
}

TEST_F(Annealing, StaysAwayWhereTheScanLeavesEnough) {
  Scan scan = scan_;
  scan.ranges.setConstant(1000.0F);  // beyond field_max_range: tells nothing
  ParticleFilter filter = started(200, 100, 4);
  EXPECT_FALSE(filter.update(map_.get(), scan).resampled);
}

TEST_F(Annealing, MovesNothingWhereTheMotionIsDeterministic) {
  MotionModelParameters motion;
  motion.deterministic = true;
  ParticleFilter filter = started(200, 100, 5, motion);
  const Eigen::ArrayXd before = filter.particles().x;
  EXPECT_FALSE(filter.update(map_.get(), scan_).resampled);
  EXPECT_TRUE((filter.particles().x == before).all());
}

}  // namespace
}  // namespace racecar_mcl
