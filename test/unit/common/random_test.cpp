#include "racecar_mcl/common/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace racecar_mcl {
namespace {

TEST(Random, FollowsItsSpecification) {
  // xoshiro256++ over a splitmix64 state, computed by an implementation in another language.
  Random zero(0);
  EXPECT_EQ(zero(), 0x53175d61490b23dfULL);
  EXPECT_EQ(zero(), 0x61da6f3dc380d507ULL);
  EXPECT_EQ(zero(), 0x5c0fdf91ec9a7bfcULL);
  Random answer(42);
  EXPECT_EQ(answer(), 0xd0764d4f4476689fULL);
}

TEST(Random, IsReproducibleForASeed) {
  Random a(7), b(7), c(8);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const double value = a.gaussian();
    EXPECT_EQ(value, b.gaussian());
    differs = differs || value != c.gaussian();
  }
  EXPECT_TRUE(differs);
}

TEST(Random, UniformStaysInItsIntervalAndFillsItEvenly) {
  Random random(1);
  const int count = 100000;
  double sum = 0.0, lowest = 1.0, highest = 0.0;
  for (int i = 0; i < count; ++i) {
    const double value = random.uniform();
    sum += value;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  EXPECT_GE(lowest, 0.0);
  EXPECT_LT(lowest, 1e-3);
  EXPECT_LT(highest, 1.0);
  EXPECT_GT(highest, 1.0 - 1e-3);
  EXPECT_NEAR(sum / count, 0.5, 5.0 / std::sqrt(12.0 * count));
}

TEST(Random, IndexHitsEveryValueEquallyOften) {
  Random random(2);
  const int values = 13, count = 130000;
  std::vector<int> hits(values, 0);
  for (int i = 0; i < count; ++i) ++hits[random.index(values)];
  double chi_squared = 0.0;
  const double expected = static_cast<double>(count) / values;
  for (const int hit : hits) chi_squared += (hit - expected) * (hit - expected) / expected;
  EXPECT_LT(chi_squared, 32.9);  // the 99.9 % quantile of 12 degrees of freedom
}

TEST(Random, GaussianHasTheMomentsAndTailsOfANormal) {
  Random random(3);
  const int count = 200000;
  double sum = 0.0, squares = 0.0, cubes = 0.0, fourths = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < count; ++i) {
    const double value = random.gaussian();
    sum += value;
    squares += value * value;
    cubes += value * value * value;
    fourths += value * value * value * value;
    if (std::abs(value) > 2.0) ++beyond_two;
  }
  // Five standard deviations of each moment: 1, 2, 15 and 96 are the variances of x .. x^4.
  const double root = 5.0 / std::sqrt(static_cast<double>(count));
  EXPECT_NEAR(sum / count, 0.0, root);
  EXPECT_NEAR(squares / count, 1.0, root * std::sqrt(2.0));
  EXPECT_NEAR(cubes / count, 0.0, root * std::sqrt(15.0));
  EXPECT_NEAR(fourths / count, 3.0, root * std::sqrt(96.0));
  EXPECT_NEAR(beyond_two / static_cast<double>(count), 0.0455, root * std::sqrt(0.0455));
}

}  // namespace
}  // namespace racecar_mcl
