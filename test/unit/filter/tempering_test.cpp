#include "racecar_mcl/filter/tempering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/filter/resampling.h"

namespace racecar_mcl {
namespace {

double sampleSizeAfter(Eigen::ArrayXd log_weights, const Eigen::ArrayXd& log_likelihoods,
                       double exponent) {
  log_weights += exponent * log_likelihoods;
  normalizeLogWeights(&log_weights);
  return effectiveSampleSize(log_weights.exp());
}

TEST(TemperingExponent, LeavesTheWantedSampleSize) {
  const Eigen::ArrayXd log_weights = Eigen::ArrayXd::Constant(1000, -std::log(1000.0));
  const Eigen::ArrayXd log_likelihoods = Eigen::ArrayXd::LinSpaced(1000, -200.0, 0.0);
  const double exponent = temperingExponent(log_weights, log_likelihoods, 100.0);
  EXPECT_GT(exponent, 0.0);
  EXPECT_LT(exponent, 1.0);
  EXPECT_NEAR(sampleSizeAfter(log_weights, log_likelihoods, exponent), 100.0, 1.0);
}

TEST(TemperingExponent, IsOneIfTheScanLeavesEnough) {
  const Eigen::ArrayXd log_weights = Eigen::ArrayXd::Zero(1000);
  const Eigen::ArrayXd log_likelihoods = Eigen::ArrayXd::LinSpaced(1000, -0.1, 0.0);
  EXPECT_EQ(temperingExponent(log_weights, log_likelihoods, 100.0), 1.0);
}

TEST(TemperingExponent, IsOneForAZeroLikelihood) {
  Eigen::ArrayXd log_likelihoods = Eigen::ArrayXd::LinSpaced(100, -50.0, 0.0);
  log_likelihoods[0] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(temperingExponent(Eigen::ArrayXd::Zero(100), log_likelihoods, 20.0), 1.0);
}

}  // namespace
}  // namespace racecar_mcl
