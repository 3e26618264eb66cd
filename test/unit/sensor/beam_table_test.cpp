#include "racecar_mcl/sensor/beam_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

/// The report's formulas (section 2.2), entry by entry.
std::vector<std::vector<double>> plainTable(const BeamTableParameters& p) {
  const int width = p.table_width;
  const int z_max = width - 1;
  const double pi = std::acos(-1.0);
  std::vector<std::vector<double>> table(width, std::vector<double>(width, 0.0));  // [z][d]
  for (int d = 0; d < width; ++d) {
    double hit_sum = 0.0;
    std::vector<double> hit(width);
    for (int z = 0; z < width; ++z) {
      hit[z] = 1.0 / std::sqrt(2.0 * pi * p.sigma_hit * p.sigma_hit) *
               std::exp(-((z - d) * (z - d)) / (2.0 * p.sigma_hit * p.sigma_hit));
      hit_sum += hit[z];
    }
    double column_sum = 0.0;
    for (int z = 0; z < width; ++z) {
      double value = p.alpha_hit * hit[z] / hit_sum;
      if (d != 0 && z <= d) {
        value += p.alpha_short * 2.0 / d * (1.0 - static_cast<double>(z) / d);
      }
      if (z == z_max) value += p.alpha_max;
      value += p.alpha_rand / z_max;
      table[z][d] = value;
      column_sum += value;
    }
    for (int z = 0; z < width; ++z) table[z][d] /= column_sum;
  }
  return table;
}

BeamTableParameters parametersOf(double hit, double shorter, double max, double rand, double sigma,
                                 int width) {
  BeamTableParameters parameters;
  parameters.alpha_hit = hit;
  parameters.alpha_short = shorter;
  parameters.alpha_max = max;
  parameters.alpha_rand = rand;
  parameters.sigma_hit = sigma;
  parameters.table_width = width;
  return parameters;
}

const BeamTableParameters kReport = parametersOf(0.74, 0.07, 0.07, 0.12, 8.0, 201);

class BeamTable : public testing::TestWithParam<BeamTableParameters> {};

TEST_P(BeamTable, EqualsTheFormulas) {
  const Eigen::ArrayXXd table = makeBeamTable(GetParam());
  const std::vector<std::vector<double>> expected = plainTable(GetParam());
  ASSERT_EQ(table.rows(), GetParam().table_width);
  ASSERT_EQ(table.cols(), GetParam().table_width);
  for (Eigen::Index z = 0; z < table.rows(); ++z) {
    for (Eigen::Index d = 0; d < table.cols(); ++d) {
      ASSERT_NEAR(table(z, d), expected[z][d], 1e-12) << "z " << z << ", d " << d;
    }
  }
}

TEST_P(BeamTable, EachColumnIsAProbabilityDistribution) {
  const Eigen::ArrayXXd table = makeBeamTable(GetParam());
  EXPECT_GE(table.minCoeff(), 0.0);
  for (Eigen::Index d = 0; d < table.cols(); ++d) EXPECT_NEAR(table.col(d).sum(), 1.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Parameters, BeamTable,
                         testing::Values(kReport, BeamTableParameters{},
                                         parametersOf(0.9, 0.0, 0.05, 0.05, 1.0, 801),
                                         parametersOf(0.0, 0.5, 0.25, 0.25, 8.0, 50),
                                         parametersOf(1.0, 0.0, 0.0, 0.0, 0.5, 101),
                                         parametersOf(0.0, 0.0, 1.0, 0.0, 1.0, 11),
                                         parametersOf(0.3, 0.3, 0.2, 0.2, 100.0, 2)));

TEST(BeamTableOfTheReport, PeaksWhereMeasuredIsExpected) {
  const Eigen::ArrayXXd table = makeBeamTable(kReport);
  for (const int d : {40, 100, 160}) {
    Eigen::Index peak = 0;
    table.col(d).head(200).maxCoeff(&peak);
    EXPECT_EQ(peak, d);
  }
  // Maximum ranges are likely for every expected range; ranges beyond the expected one are not.
  EXPECT_GT(table(200, 100), 0.05);
  EXPECT_LT(table(199, 100), 0.001);
  // Short ranges are more likely near the lidar.
  EXPECT_GT(table(5, 100), table(60, 100));
}

TEST(BeamTableParameters, RejectValuesOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const BeamTableParameters bad[] = {
      parametersOf(0.74, 0.07, 0.07, 0.13, 8.0, 201),   // sum 1.01
      parametersOf(0.5, 0.07, 0.07, 0.12, 8.0, 201),    // sum 0.76
      parametersOf(0.84, -0.03, 0.07, 0.12, 8.0, 201),  // negative
      parametersOf(nan, 0.07, 0.07, 0.12, 8.0, 201),
      parametersOf(0.74, 0.07, 0.07, inf, 8.0, 201),
      parametersOf(1.5, 0.07, 0.07, -0.64, 8.0, 201),
      parametersOf(0.0, 1.0, 0.0, 0.0, 8.0, 201),  // undefined for an expected range of 0
      parametersOf(0.74, 0.07, 0.07, 0.12, 0.0, 201),
      parametersOf(0.74, 0.07, 0.07, 0.12, -8.0, 201),
      parametersOf(0.74, 0.07, 0.07, 0.12, nan, 201),
      parametersOf(0.74, 0.07, 0.07, 0.12, inf, 201),
      parametersOf(0.74, 0.07, 0.07, 0.12, 8.0, 1),
      parametersOf(0.74, 0.07, 0.07, 0.12, 8.0, 0),
      parametersOf(0.74, 0.07, 0.07, 0.12, 8.0, -201),
      parametersOf(0.74, 0.07, 0.07, 0.12, 8.0, 1000000)};
  for (const BeamTableParameters& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(makeBeamTable(parameters), ParameterError);
  }
}

TEST(BeamTableParameters, ErrorsNameTheParameter) {
  try {
    validate(parametersOf(0.74, 0.07, 0.07, 0.12, -3.0, 201));
    FAIL() << "no exception";
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("sigma_hit"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("-3"), std::string::npos);
  }
}

}  // namespace
}  // namespace racecar_mcl
