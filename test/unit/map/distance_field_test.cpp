#include "racecar_mcl/map/distance_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

TEST(Clearances, AreZeroNextToAnObstacleAndGrowFromThere) {
  const std::vector<std::uint8_t> mask = {1, 0, 0, 0, 0,  //
                                          0, 0, 0, 0, 0,  //
                                          0, 0, 0, 0, 0,  //
                                          0, 0, 0, 0, 0};
  const std::vector<float> field = clearances(mask, 5, 4);
  EXPECT_EQ(field[0], 0.0F);
  EXPECT_EQ(field[1], 0.0F);
  EXPECT_EQ(field[6], 0.0F);
  EXPECT_EQ(field[2], 1.0F);
  EXPECT_EQ(field[4], 3.0F);
  EXPECT_FLOAT_EQ(field[12], std::sqrt(2.0F));
  EXPECT_FLOAT_EQ(field[19], std::sqrt(13.0F));
}

TEST(Clearances, AreTheGapsBetweenSquares) {
  constexpr int kWidth = 37;
  constexpr int kHeight = 23;
  Random random(3);
  std::vector<std::uint8_t> mask(kWidth * kHeight);
  for (std::uint8_t& cell : mask) cell = random.uniform() < 0.01 ? 1 : 0;
  const std::vector<float> field = clearances(mask, kWidth, kHeight);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int j = 0; j < kWidth * kHeight; ++j) {
      if (mask[static_cast<std::size_t>(j)] == 0) continue;
      const int columns = std::max(std::abs(i % kWidth - j % kWidth) - 1, 0);
      const int rows = std::max(std::abs(i / kWidth - j / kWidth) - 1, 0);
      nearest = std::min(nearest, std::hypot(columns, rows));
    }
    EXPECT_NEAR(static_cast<double>(field[static_cast<std::size_t>(i)]), nearest, 1e-5);
  }
}

TEST(Clearances, AreInfiniteWithoutAnObstacle) {
  for (const float clearance : clearances(std::vector<std::uint8_t>(6, 0), 3, 2)) {
    EXPECT_TRUE(std::isinf(clearance));
  }
}

TEST(Clearances, RejectAMaskOfAnotherSize) {
  EXPECT_THROW(clearances(std::vector<std::uint8_t>(5, 0), 3, 2), std::invalid_argument);
  EXPECT_THROW(clearances({}, 0, 0), std::invalid_argument);
}

}  // namespace
}  // namespace racecar_mcl
