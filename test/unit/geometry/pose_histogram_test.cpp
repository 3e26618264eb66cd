#include "racecar_mcl/geometry/pose_histogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace racecar_mcl {
namespace {

TEST(PoseBin, ContainsThePosesOfASquareAndASector) {
  const PoseBins bins{0.5, kPi / 4};
  EXPECT_EQ(yawBinCount(bins), 8);
  EXPECT_TRUE(binOf({0.1, 0.1, 0.1}, bins) == binOf({0.4, 0.4, 0.7}, bins));
  EXPECT_FALSE(binOf({0.1, 0.1, 0.1}, bins) == binOf({-0.1, 0.1, 0.1}, bins));
  EXPECT_FALSE(binOf({0.1, 0.1, 0.1}, bins) == binOf({0.1, 0.6, 0.1}, bins));
  EXPECT_FALSE(binOf({0.1, 0.1, 0.1}, bins) == binOf({0.1, 0.1, -0.1}, bins));
  EXPECT_TRUE(binOf({0.1, 0.1, 0.1}, bins) == binOf({0.1, 0.1, 0.1 - 2 * kPi}, bins));
}

TEST(PoseBin, ClampsPosesThatAreFarOrNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e300}) {
    const PoseBin bin = binOf({bad, bad, 0.0}, {});
    EXPECT_EQ(std::abs(bin.x), 1000000000);
    EXPECT_EQ(std::abs(bin.y), 1000000000);
  }
  for (const double bad : {nan, inf, -inf}) {
    const PoseBin bin = binOf({0.0, 0.0, bad}, {});
    EXPECT_GE(bin.yaw, 0);
    EXPECT_LT(bin.yaw, yawBinCount({}));
  }
}

TEST(BinNumbers, CountUpInTheOrderOfTheBins) {
  BinNumbers numbers;
  for (int round = 0; round < 2; ++round) {
    numbers.reset(1000);
    EXPECT_EQ(numbers.size(), 0);
    for (int i = 0; i < 1000; ++i) {
      const PoseBin bin{i % 10 - 5, i / 10 - 50, i % 7};
      EXPECT_EQ(numbers.find(bin), -1);
      EXPECT_EQ(numbers.add(bin), i);
      EXPECT_EQ(numbers.add(bin), i) << "again";
      EXPECT_EQ(numbers.find(bin), i);
      EXPECT_TRUE(numbers[i] == bin);
    }
    EXPECT_EQ(numbers.size(), 1000);
  }
}

TEST(BinNumbers, FindNothingWithoutCapacity) {
  BinNumbers numbers;
  numbers.reset(0);
  EXPECT_EQ(numbers.find({}), -1);
}

}  // namespace
}  // namespace racecar_mcl
