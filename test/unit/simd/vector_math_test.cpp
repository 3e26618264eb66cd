#include "simd/vector_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "simd/normal_generator.h"

namespace racecar_mcl {
namespace {

TEST(VectorMath, SineAndCosineAgreeWithTheLibrary) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const double angle = random.uniform(-1.0, 1.0) * (i % 2 == 0 ? 7.0 : 1e5);
    double sine = 0.0, cosine = 0.0;
    sinCos(angle, &sine, &cosine);
    ASSERT_NEAR(sine, std::sin(angle), 5e-16) << angle;
    ASSERT_NEAR(cosine, std::cos(angle), 5e-16) << angle;
  }
}

TEST(VectorMath, WrappedAnglesAgreeWithTheLibrary) {
  Random random(2);
  for (int i = 0; i < 100000; ++i) {
    const double angle = random.uniform(-20.0, 20.0);
    ASSERT_NEAR(wrapAngleFast(angle), wrapAngle(angle), 1e-14) << angle;
  }
  for (const double edge : {-kPi, kPi, 3.0 * kPi, -3.0 * kPi}) {
    EXPECT_NEAR(std::abs(wrapAngleFast(edge)), kPi, 1e-14);
    EXPECT_LE(wrapAngleFast(edge), kPi);
    EXPECT_GT(wrapAngleFast(edge), -kPi);
  }
}

TEST(VectorMath, ExponentialsAgreeWithTheLibrary) {
  Random random(3);
  for (int i = 0; i < 100000; ++i) {
    const double x = -std::pow(10.0, random.uniform(-12.0, 2.84));
    ASSERT_NEAR(expOfNegative(x) / std::exp(x), 1.0, 1e-15) << x;
  }
  EXPECT_EQ(expOfNegative(0.0), 1.0);
  EXPECT_EQ(expOfNegative(-1000.0), 0.0);
  EXPECT_EQ(expOfNegative(-std::numeric_limits<double>::infinity()), 0.0);
  EXPECT_TRUE(std::isnan(expOfNegative(std::numeric_limits<double>::quiet_NaN())));
}

TEST(VectorMath, LogarithmsAgreeWithTheLibrary) {
  Random random(4);
  for (int i = 0; i < 100000; ++i) {
    const double x = std::pow(2.0, random.uniform(-40.0, 4.0));
    ASSERT_NEAR(logOfPositive(x), std::log(x), 1e-15 + 4e-16 * std::abs(std::log(x))) << x;
  }
  EXPECT_EQ(logOfPositive(1.0), 0.0);
}

TEST(VectorMath, EveryInstructionSetGivesTheSameNoise) {
  constexpr int kCount = 320;
  std::vector<std::vector<double>> values;
  for (const InstructionSet set : availableInstructionSets()) {
    values.emplace_back(kCount);
    NoiseLanes random(5);
    double* const out = values.back().data();
    runWith(set, [&]() RACECAR_MCL_INLINE_LAMBDA { random.fillGaussian(out, kCount); });
    EXPECT_EQ(values.back(), values.front()) << nameOf(set);
  }
}

TEST(NoiseLanes, DrawIndependentStandardNormals) {
  constexpr int kCount = 32 * 20000;
  std::vector<double> values(kCount);
  NoiseLanes random(6);
  random.fillGaussian(values.data(), kCount);
  double sum = 0.0, squares = 0.0, fourths = 0.0, neighbours = 0.0, pairs = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double v = values[static_cast<std::size_t>(i)];
    sum += v;
    squares += v * v;
    fourths += v * v * v * v;
    beyond_two += std::abs(v) > 2.0 ? 1 : 0;
    neighbours += v * values[static_cast<std::size_t>((i + 1) % kCount)];
    pairs += v * values[static_cast<std::size_t>((i + 16) % kCount)];
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.006);
  EXPECT_NEAR(squares / kCount, 1.0, 0.01);
  EXPECT_NEAR(fourths / kCount, 3.0, 0.06);
  EXPECT_NEAR(static_cast<double>(beyond_two) / kCount, 0.0455, 0.0015);
  EXPECT_NEAR(neighbours / kCount, 0.0, 0.006);
  EXPECT_NEAR(pairs / kCount, 0.0, 0.006);
}

}  // namespace
}  // namespace racecar_mcl
