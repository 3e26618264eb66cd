#include "racecar_mcl/sensor/beam_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The report's table with pixels of 0.1 m, with independent beams.
BeamModelParameters plain() {
  BeamModelParameters parameters;
  parameters.table = {0.74, 0.07, 0.07, 0.12, 8.0, 201};
  parameters.lidar_scale_to_map_scale = 1.0;
  parameters.pixels_per_cell = 1.0;
  parameters.likelihood_exponent = 1.0;
  return parameters;
}

constexpr double kResolution = 0.1;  // m

double logLikelihoodOf(const BeamModel& model, const Eigen::ArrayXf& measured,
                       const Eigen::ArrayXf& expected) {
  Eigen::ArrayXXf column(expected.size(), 1);
  column.col(0) = expected;
  Eigen::ArrayXd result(1);
  model.logLikelihood(measured, column, result);
  return result[0];
}

double logLikelihoodOf(const BeamModel& model, float measured, float expected) {
  return logLikelihoodOf(model, Eigen::ArrayXf::Constant(1, measured),
                         Eigen::ArrayXf::Constant(1, expected));
}

TEST(BeamModel, IsTheLogarithmOfTheProductOfTheTablesEntries) {
  const BeamModel model(plain(), kResolution);
  const Eigen::ArrayXXd table = makeBeamTable(plain().table);
  Eigen::ArrayXf measured(4);
  measured << 1.0f, 5.0f, 12.3f, 20.0f;
  Eigen::ArrayXXf expected(4, 2);
  expected << 1.1f, 3.0f, 5.0f, 7.0f, 12.0f, 15.0f, 19.0f, 20.0f;
  Eigen::ArrayXd result(2);
  model.logLikelihood(measured, expected, result);
  const double products[] = {table(10, 11) * table(50, 50) * table(123, 120) * table(200, 190),
                             table(10, 30) * table(50, 70) * table(123, 150) * table(200, 200)};
  EXPECT_NEAR(std::exp(result[0]) / products[0], 1.0, 1e-5);
  EXPECT_NEAR(std::exp(result[1]) / products[1], 1.0, 1e-5);
}

TEST(BeamModel, RoundsToTheNearestPixel) {
  const BeamModel model(plain(), kResolution);
  for (const float range : {4.96f, 5.0f, 5.04f}) {
    EXPECT_EQ(logLikelihoodOf(model, range, 7.0f), logLikelihoodOf(model, 5.0f, 7.0f));
    EXPECT_EQ(logLikelihoodOf(model, 7.0f, range), logLikelihoodOf(model, 7.0f, 5.0f));
  }
  EXPECT_NE(logLikelihoodOf(model, 4.94f, 7.0f), logLikelihoodOf(model, 5.0f, 7.0f));
  EXPECT_NE(logLikelihoodOf(model, 5.06f, 7.0f), logLikelihoodOf(model, 5.0f, 7.0f));
  EXPECT_EQ(logLikelihoodOf(model, 19.96f, 7.0f), logLikelihoodOf(model, 20.0f, 7.0f));
}

TEST(BeamModel, ClipsToTheTable) {
  const BeamModel model(plain(), kResolution);
  EXPECT_NEAR(model.maxRange(), 20.0, 1e-9);
  for (const float far : {20.0f, 20.4f, 1e6f, 3e38f, kInf}) {
    EXPECT_EQ(logLikelihoodOf(model, far, 7.0f), logLikelihoodOf(model, 20.0f, 7.0f));
    EXPECT_EQ(logLikelihoodOf(model, 7.0f, far), logLikelihoodOf(model, 7.0f, 20.0f));
  }
  for (const float near : {0.0f, 0.04f, -1.0f, -kInf}) {
    EXPECT_EQ(logLikelihoodOf(model, near, 7.0f), logLikelihoodOf(model, 0.0f, 7.0f));
    EXPECT_EQ(logLikelihoodOf(model, 7.0f, near), logLikelihoodOf(model, 7.0f, 0.0f));
  }
}

TEST(BeamModel, HandlesNaN) {
  const BeamModel model(plain(), kResolution);
  EXPECT_TRUE(std::isfinite(logLikelihoodOf(model, kNan, 7.0f)));
  EXPECT_TRUE(std::isfinite(logLikelihoodOf(model, 7.0f, kNan)));
}

TEST(BeamModel, DoesNotUnderflow) {
  const BeamModel model(plain(), kResolution);
  const Eigen::ArrayXXd table = makeBeamTable(plain().table);
  // 35 beams give 1e-104; the last two are far below the smallest double, 1e-324.
  double before = -104.0 * std::log(10.0);
  for (const int beams : {35, 100, 1000, 10000}) {
    const double expected = beams * std::log(table(150, 20));
    const double log_likelihood = logLikelihoodOf(model, Eigen::ArrayXf::Constant(beams, 15.0f),
                                                  Eigen::ArrayXf::Constant(beams, 2.0f));
    EXPECT_NEAR(log_likelihood / expected, 1.0, 1e-4) << beams << " beams";
    EXPECT_LT(log_likelihood, before);
    before = log_likelihood;
    EXPECT_TRUE(std::isfinite(log_likelihood));
  }
}

TEST(BeamModel, AppliesTheExponent) {
  BeamModelParameters correlated = plain();
  correlated.likelihood_exponent = 1.0 / 2.2;
  const Eigen::ArrayXf measured = Eigen::ArrayXf::LinSpaced(50, 1.0f, 18.0f);
  const Eigen::ArrayXf expected = measured + 0.7f;
  EXPECT_NEAR(logLikelihoodOf(BeamModel(correlated, kResolution), measured, expected),
              logLikelihoodOf(BeamModel(plain(), kResolution), measured, expected) / 2.2, 1e-9);
}

TEST(BeamModel, PixelsFollowResolutionAndScales) {
  // Each of them is one pixel from the expected range.
  const double expected = logLikelihoodOf(BeamModel(plain(), kResolution), 5.0f, 7.0f);
  EXPECT_NEAR(logLikelihoodOf(BeamModel(plain(), 0.05), 2.5f, 3.5f), expected, 1e-6);
  BeamModelParameters coarser = plain();
  coarser.lidar_scale_to_map_scale = 2.0;
  EXPECT_NEAR(logLikelihoodOf(BeamModel(coarser, kResolution), 10.0f, 14.0f), expected, 1e-6);
  EXPECT_NEAR(BeamModel(coarser, kResolution).maxRange(), 40.0, 1e-9);
  BeamModelParameters finer = plain();
  finer.pixels_per_cell = 4.0;
  EXPECT_NEAR(logLikelihoodOf(BeamModel(finer, kResolution), 1.25f, 1.75f), expected, 1e-6);
  EXPECT_NEAR(BeamModel(finer, kResolution).maxRange(), 5.0, 1e-9);
}

TEST(BeamModel, PrefersTheParticleWithTheMeasuredRanges) {
  const BeamModel model(plain(), kResolution);
  const Eigen::ArrayXf measured = Eigen::ArrayXf::LinSpaced(40, 2.0f, 15.0f);
  Eigen::ArrayXXf expected(40, 21);
  for (Eigen::Index i = 0; i < 21; ++i) {
    expected.col(i) = measured + 0.1f * static_cast<float>(i - 10);
  }
  Eigen::ArrayXd result(21);
  model.logLikelihood(measured, expected, result);
  Eigen::Index best = 0;
  result.maxCoeff(&best);
  EXPECT_EQ(best, 10);
}

TEST(BeamModel, IsMinusInfinityIfTheTableHasAZero) {
  BeamModelParameters parameters = plain();
  parameters.table = {0.0, 0.9, 0.1, 0.0, 8.0, 201};  // no ranges beyond the expected one
  const BeamModel model(parameters, kResolution);
  EXPECT_EQ(logLikelihoodOf(model, 12.0f, 7.0f), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(logLikelihoodOf(model, 6.0f, 7.0f)));
}

TEST(BeamModelParameters, RejectScalesOutOfRange) {
  double BeamModelParameters::*const scales[] = {&BeamModelParameters::lidar_scale_to_map_scale,
                                                 &BeamModelParameters::pixels_per_cell,
                                                 &BeamModelParameters::likelihood_exponent};
  EXPECT_NO_THROW(validate(BeamModelParameters{}));
  for (const auto scale : scales) {
    for (const double bad : {0.0, -2.2, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e-9, 1e9}) {
      BeamModelParameters parameters;
      parameters.*scale = bad;
      EXPECT_THROW(validate(parameters), ParameterError);
      EXPECT_THROW(BeamModel(parameters, kResolution), ParameterError);
    }
  }
  BeamModelParameters table;
  table.table.alpha_hit += 0.5;
  EXPECT_THROW(validate(table), ParameterError);
}

TEST(BeamModel, RejectsInvalidResolutions) {
  for (const double bad : {0.0, -0.05, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(BeamModel(plain(), bad), ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
