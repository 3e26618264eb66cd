#include "calibration/beam_model_estimation.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

/// Beams sampled from the table, for all expected ranges.
Eigen::ArrayXXd sampleTable(const BeamTableParameters& table, int beams, Random* random) {
  const Eigen::ArrayXXd likelihood = makeBeamTable(table);
  Eigen::ArrayXXd counts = Eigen::ArrayXXd::Zero(likelihood.rows(), likelihood.cols());
  for (int i = 0; i < beams; ++i) {
    const auto d = static_cast<Eigen::Index>(random->index(likelihood.cols()));
    double left = random->uniform();
    Eigen::Index z = 0;
    while (z + 1 < likelihood.rows() && (left -= likelihood(z, d)) >= 0.0) ++z;
    counts(z, d) += 1.0;
  }
  return counts;
}

void expectWithinTenPercent(const BeamTableParameters& estimated,
                            const BeamTableParameters& truth) {
  EXPECT_NEAR(estimated.alpha_hit, truth.alpha_hit, 0.1 * truth.alpha_hit);
  EXPECT_NEAR(estimated.alpha_short, truth.alpha_short, 0.1 * truth.alpha_short);
  EXPECT_NEAR(estimated.alpha_max, truth.alpha_max, 0.1 * truth.alpha_max);
  EXPECT_NEAR(estimated.alpha_rand, truth.alpha_rand, 0.1 * truth.alpha_rand);
  EXPECT_NEAR(estimated.sigma_hit, truth.sigma_hit, 0.1 * truth.sigma_hit);
  EXPECT_EQ(estimated.table_width, truth.table_width);
}

TEST(FitSensorTable, RecoversTheConstantsThatMadeTheBeams) {
  Random random(1);
  const BeamTableParameters truths[] = {{0.74, 0.07, 0.07, 0.12, 8.0, 201},
                                        {0.55, 0.25, 0.05, 0.15, 2.0, 201},
                                        {0.85, 0.05, 0.05, 0.05, 0.6, 101},
                                        {0.40, 0.20, 0.30, 0.10, 30.0, 401}};
  for (const BeamTableParameters& truth : truths) {
    SCOPED_TRACE(truth.sigma_hit);
    BeamTableParameters start;
    start.table_width = truth.table_width;
    const BeamModelEstimate fit = estimateBeamModel(sampleTable(truth, 100000, &random), start);
    expectWithinTenPercent(fit.table, truth);
    EXPECT_GE(fit.log_likelihood, fit.log_likelihood_before);
    EXPECT_NO_THROW(validate(fit.table));
  }
}

TEST(FitSensorTable, IsExactWhereTheCountsAre) {
  const BeamTableParameters truth{0.6, 0.15, 0.05, 0.2, 5.0, 101};
  const BeamModelEstimate fit =
      estimateBeamModel(makeBeamTable(truth), {0.25, 0.25, 0.25, 0.25, 20.0, 101});
  EXPECT_NEAR(fit.table.alpha_hit, truth.alpha_hit, 1e-4);
  EXPECT_NEAR(fit.table.alpha_short, truth.alpha_short, 1e-4);
  EXPECT_NEAR(fit.table.alpha_max, truth.alpha_max, 1e-4);
  EXPECT_NEAR(fit.table.alpha_rand, truth.alpha_rand, 1e-4);
  EXPECT_NEAR(fit.table.sigma_hit, truth.sigma_hit, 1e-3);
}

TEST(FitSensorTable, NoOtherConstantsMakeTheBeamsMoreLikely) {
  Random random(2);
  const Eigen::ArrayXXd counts = sampleTable({0.7, 0.1, 0.1, 0.1, 3.0, 101}, 3000, &random);
  BeamTableParameters start;
  start.table_width = 101;
  const BeamModelEstimate fit = estimateBeamModel(counts, start);
  for (const double step : {-0.01, 0.01}) {
    BeamTableParameters other = fit.table;
    other.sigma_hit *= 1.0 + step;
    EXPECT_LT(meanLogLikelihood(counts, other), fit.log_likelihood);
    for (double BeamTableParameters::*share :
         {&BeamTableParameters::alpha_short, &BeamTableParameters::alpha_max,
          &BeamTableParameters::alpha_rand}) {
      other = fit.table;
      other.*share += step;
      other.alpha_hit -= step;
      EXPECT_LT(meanLogLikelihood(counts, other), fit.log_likelihood);
    }
  }
}

TEST(FitSensorTable, FindsSharesThatTheStartTakesForZeroAndThoseThatAreZero) {
  Random random(3);
  const BeamTableParameters truth{0.8, 0.0, 0.2, 0.0, 4.0, 201};
  const BeamModelEstimate fit =
      estimateBeamModel(sampleTable(truth, 20000, &random), {0.9, 0.1, 0.0, 0.0, 8.0, 201});
  EXPECT_NEAR(fit.table.alpha_hit, 0.8, 0.02);
  EXPECT_NEAR(fit.table.alpha_max, 0.2, 0.02);
  EXPECT_LT(fit.table.alpha_short + fit.table.alpha_rand, 0.01);
}

TEST(FitSensorTable, StaysFiniteWhereAllBeamsAreAlike) {
  Eigen::ArrayXXd counts = Eigen::ArrayXXd::Zero(201, 201);
  counts(100, 100) = 1000.0;
  const BeamModelEstimate fit = estimateBeamModel(counts, {});
  EXPECT_TRUE(std::isfinite(fit.log_likelihood));
  EXPECT_NO_THROW(validate(fit.table));
  counts.setZero();
  counts(200, 30) = 1000.0;
  EXPECT_NO_THROW(validate(estimateBeamModel(counts, {}).table));
}

TEST(FitSensorTable, RefusesCountsThatAreEmptyOrOfAnotherSize) {
  EXPECT_THROW(estimateBeamModel(Eigen::ArrayXXd::Zero(201, 201), {}), std::invalid_argument);
  EXPECT_THROW(estimateBeamModel(Eigen::ArrayXXd::Ones(101, 101), {}), std::invalid_argument);
}

TEST(RangeCounts, RoundsToThePixelsOfTheBeamModel) {
  RangeCounts counts({}, 0.05);
  EXPECT_DOUBLE_EQ(counts.pixel(), 0.05);
  EXPECT_DOUBLE_EQ(counts.maxRange(), 10.0);
  Eigen::ArrayXf measured(4), expected(4);
  measured << 0.024f, 1.026f, 12.0f, std::numeric_limits<float>::infinity();
  expected << 0.0f, 0.976f, 10.0f, 3.0f;
  counts.add(measured, expected);
  EXPECT_EQ(counts.total(), 4.0);
  EXPECT_EQ(counts.counts()(0, 0), 1.0);
  EXPECT_EQ(counts.counts()(21, 20), 1.0);
  EXPECT_EQ(counts.counts()(200, 200), 1.0);
  EXPECT_EQ(counts.counts()(200, 60), 1.0);
}

}  // namespace
}  // namespace racecar_mcl
