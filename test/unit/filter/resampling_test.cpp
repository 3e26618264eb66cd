#include "racecar_mcl/filter/resampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace racecar_mcl {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Particle i is at x = i.
ParticleSet weighted(const std::vector<double>& weights) {
  ParticleSet particles;
  particles.resize(static_cast<Eigen::Index>(weights.size()));
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    particles.setPose(i, {static_cast<double>(i), 2.0 * static_cast<double>(i), 0.1});
    particles.log_weight[i] = std::log(weights[static_cast<std::size_t>(i)]);
  }
  return particles;
}

/// How often each particle of the set was drawn.
std::vector<int> countsOf(const ParticleSet& drawn, std::size_t sources) {
  std::vector<int> counts(sources, 0);
  for (Eigen::Index i = 0; i < drawn.size(); ++i) ++counts[static_cast<std::size_t>(drawn.x[i])];
  return counts;
}

TEST(NormalizeLogWeights, MakesTheWeightsSumToOne) {
  Eigen::ArrayXd logs(3);
  logs << std::log(2.0), std::log(6.0), std::log(8.0);
  EXPECT_NEAR(normalizeLogWeights(&logs), std::log(16.0), 1e-12);
  EXPECT_NEAR(std::exp(logs[0]), 0.125, 1e-12);
  EXPECT_NEAR(std::exp(logs[1]), 0.375, 1e-12);
  EXPECT_NEAR(std::exp(logs[2]), 0.5, 1e-12);
}

TEST(NormalizeLogWeights, HandlesAnyScale) {
  for (const double offset : {-1e6, -745.0, 0.0, 800.0, 1e6}) {
    Eigen::ArrayXd logs(2);
    logs << offset, offset + std::log(3.0);
    EXPECT_NEAR(normalizeLogWeights(&logs), offset + std::log(4.0), 1e-8);
    EXPECT_NEAR(std::exp(logs[0]), 0.25, 1e-9);
  }
}

TEST(NormalizeLogWeights, AllowsSomeWeightsToBeZero) {
  Eigen::ArrayXd logs(3);
  logs << -kInf, -700.0, -kInf;
  EXPECT_NEAR(normalizeLogWeights(&logs), -700.0, 1e-9);
  EXPECT_EQ(logs[0], -kInf);
  EXPECT_EQ(logs[1], 0.0);
}

TEST(NormalizeLogWeights, ReturnsMinusInfinityIfAllWeightsVanish) {
  Eigen::ArrayXd zeros = Eigen::ArrayXd::Constant(4, -kInf);
  EXPECT_EQ(normalizeLogWeights(&zeros), -kInf);
  EXPECT_TRUE((zeros == -kInf).all());
  for (const double bad : {kNan, kInf}) {
    for (Eigen::Index at = 0; at < 5; ++at) {
      Eigen::ArrayXd logs = Eigen::ArrayXd::Constant(5, -1.0);
      logs[at] = bad;
      EXPECT_EQ(normalizeLogWeights(&logs), -kInf);
      EXPECT_EQ(logs[(at + 1) % 5], -1.0);
    }
  }
  Eigen::ArrayXd empty(0);
  EXPECT_EQ(normalizeLogWeights(&empty), -kInf);
}

TEST(EffectiveSampleSize, RunsFromOneToAll) {
  EXPECT_NEAR(effectiveSampleSize(weighted({1.0, 0.0, 0.0}).log_weight.exp()), 1.0, 1e-12);
  EXPECT_NEAR(effectiveSampleSize(weighted({0.5, 0.5, 0.0}).log_weight.exp()), 2.0, 1e-12);
  EXPECT_NEAR(effectiveSampleSize(weighted({0.7, 0.2, 0.1}).log_weight.exp()), 1.0 / 0.54, 1e-12);
  EXPECT_EQ(effectiveSampleSize(Eigen::ArrayXd(0)), 0.0);
}

TEST(EffectiveSampleSize, NeverExceedsTheSetByRounding) {
  for (int count = 1; count < 3000; ++count) {
    const Eigen::ArrayXd logs = Eigen::ArrayXd::Constant(count, -std::log(count));
    EXPECT_LE(effectiveSampleSize(logs.exp()), count);
    EXPECT_NEAR(effectiveSampleSize(logs.exp()), count, 1e-8);
  }
}

class Resampling : public testing::TestWithParam<ResamplingMethod> {};

TEST_P(Resampling, DrawsInProportionToTheWeights) {
  const std::vector<double> weights{0.05, 0.0, 0.4, 0.25, 0.3};
  const ParticleSet particles = weighted(weights);
  Random random(21);
  std::vector<double> totals(weights.size(), 0.0);
  const int rounds = 400, size = 50;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<int> counts =
        countsOf(resample(particles, size, GetParam(), random), weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) totals[i] += counts[i];
  }
  const double draws = rounds * size;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double sigma = std::sqrt(draws * weights[i] * (1.0 - weights[i]));
    EXPECT_NEAR(totals[i], draws * weights[i], 5.0 * sigma) << "particle " << i;
  }
}

TEST_P(Resampling, GivesAUniformSetOfTheSizeAsked) {
  Random random(22);
  const ParticleSet particles = weighted({0.2, 0.5, 0.3});
  for (const Eigen::Index size : {1, 2, 3, 100}) {
    const ParticleSet drawn = resample(particles, size, GetParam(), random);
    ASSERT_EQ(drawn.size(), size);
    for (Eigen::Index i = 0; i < size; ++i) {
      EXPECT_NEAR(std::exp(drawn.log_weight[i]), 1.0 / static_cast<double>(size), 1e-12);
      EXPECT_EQ(drawn.y[i], 2.0 * drawn.x[i]);
      EXPECT_EQ(drawn.yaw[i], 0.1);
    }
  }
}

TEST_P(Resampling, NeverDrawsAParticleWithoutWeight) {
  Random random(23);
  const ParticleSet particles = weighted({0.0, 0.1, 0.0, 0.2, 0.7, 0.0, 0.0});
  for (int round = 0; round < 2000; ++round) {
    const std::vector<int> counts = countsOf(resample(particles, 7, GetParam(), random), 7);
    EXPECT_EQ(counts[0] + counts[2] + counts[5] + counts[6], 0);
  }
}

TEST_P(Resampling, KeepsTheOnlyParticleWithWeight) {
  Random random(24);
  const ParticleSet drawn = resample(weighted({0.0, 0.0, 1.0}), 9, GetParam(), random);
  EXPECT_TRUE((drawn.x == 2.0).all());
}

TEST_P(Resampling, IsReproducibleForASeed) {
  Random a(25), b(25);
  const ParticleSet particles = weighted({0.2, 0.5, 0.3});
  const ParticleSet first = resample(particles, 40, GetParam(), a);
  EXPECT_TRUE((first.x == resample(particles, 40, GetParam(), b).x).all());
}

TEST_P(Resampling, RejectsSetsWithoutWeight) {
  Random random(26);
  EXPECT_THROW(resample(ParticleSet{}, 5, GetParam(), random), std::invalid_argument);
  EXPECT_THROW(resample(weighted({0.0, 0.0}), 5, GetParam(), random), std::invalid_argument);
  ParticleSet broken = weighted({0.5, 0.5});
  broken.log_weight[0] = kNan;
  EXPECT_THROW(resample(broken, 5, GetParam(), random), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Methods, Resampling,
                         testing::Values(ResamplingMethod::kSystematic,
                                         ResamplingMethod::kMultinomial));

TEST(SystematicResampling, DeviatesFromTheExpectedCountByLessThanOne) {
  const std::vector<double> weights{0.013, 0.2, 0.087, 0.4, 0.3};
  Random random(27);
  for (int round = 0; round < 500; ++round) {
    const std::vector<int> counts =
        countsOf(resample(weighted(weights), 100, ResamplingMethod::kSystematic, random), 5);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_LT(std::abs(counts[i] - 100 * weights[i]), 1.0 + 1e-9);
    }
  }
}

TEST(SystematicResampling, KeepsAUniformSetAsItIs) {
  Random random(28);
  const ParticleSet particles = weighted(std::vector<double>(200, 1.0 / 200));
  const ParticleSet drawn = resample(particles, 200, ResamplingMethod::kSystematic, random);
  EXPECT_LE((drawn.x - particles.x).abs().maxCoeff(), 1.0);
  EXPECT_GE((drawn.x == particles.x).count(), 198);
}

TEST(MultinomialResampling, VariesAsIndependentDrawsDo) {
  Random random(29);
  const int rounds = 4000, size = 50;
  double squares = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<int> counts =
        countsOf(resample(weighted({0.3, 0.7}), size, ResamplingMethod::kMultinomial, random), 2);
    squares += (counts[0] - 15.0) * (counts[0] - 15.0);
  }
  EXPECT_NEAR(squares / rounds, 50 * 0.3 * 0.7, 10.5 * 5.0 * std::sqrt(2.0 / rounds));
}

TEST(OccupiedBins, CountsBinsNotParticles) {
  ParticleSet particles;
  particles.resize(6);
  particles.log_weight.setConstant(-std::log(6.0));
  particles.setPose(0, {0.1, 0.1, 0.0});
  particles.setPose(1, {0.2, 0.3, 0.01});
  particles.setPose(2, {-0.1, 0.1, 0.0});  // across zero is another bin
  particles.setPose(3, {5.0, 5.0, 0.0});
  particles.setPose(4, {5.0, 5.0, 3.14159});  // the same direction
  particles.setPose(5, {5.0, 5.0, -3.14159 + 1.0});
  EXPECT_EQ(countOccupiedBins(particles, {0.5, 0.35}), 5);
  EXPECT_EQ(countOccupiedBins(particles, {0.5, 10.0}), 3);  // one bin all round
  EXPECT_EQ(countOccupiedBins(ParticleSet{}, {0.5, 0.35}), 0);
}

TEST(OccupiedBins, HandlesPositionsBeyondAnyIndex) {
  ParticleSet particles = weighted({0.5, 0.5});
  particles.setPose(0, {1e300, -1e300, 0.0});
  particles.setPose(1, {1e300, -1e300, 0.0});
  EXPECT_EQ(countOccupiedBins(particles, {}), 1);
}

TEST(KldSampleSize, IsTheQuantileOverTwiceTheError) {
  // Fox 2003: n = chi^2_{k-1, 1-delta} / (2 epsilon). The quantiles at 0.99 are tabulated; the
  // Wilson-Hilferty approximation agrees within a few per cent.
  const struct {
    Eigen::Index bins;
    double quantile;
    double tolerance;
  } table[] = {{2, 6.635, 0.04}, {11, 23.209, 0.01}, {31, 50.892, 0.01}, {101, 135.807, 0.01}};
  for (const auto& [bins, quantile, tolerance] : table) {
    for (const double error : {0.05, 0.02}) {
      const double expected = quantile / (2.0 * error);
      EXPECT_NEAR(static_cast<double>(kldSampleSize(bins, error, 2.3263)), expected,
                  tolerance * expected + 1.0)
          << bins << " bins";
    }
  }
}

TEST(KldSampleSize, GrowsWithTheBinsAndStartsAtOne) {
  EXPECT_EQ(kldSampleSize(0), 1);
  EXPECT_EQ(kldSampleSize(1), 1);
  Eigen::Index before = 1;
  for (Eigen::Index bins = 2; bins < 500; ++bins) {
    const Eigen::Index size = kldSampleSize(bins);
    EXPECT_GT(size, before);
    before = size;
  }
}

}  // namespace
}  // namespace racecar_mcl
