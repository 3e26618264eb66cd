#include "map/distance_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "racecar_mcl/common/random.h"

namespace racecar_mcl {
namespace {

struct Mask {
  int width, height;
  std::vector<std::uint8_t> cells;

  bool at(int column, int row) const {
    return column >= 0 && column < width && row >= 0 && row < height &&
           cells[static_cast<std::size_t>(row * width + column)] != 0;
  }
};

Mask randomMask(Random* random) {
  Mask mask{1 + static_cast<int>(random->index(60)), 1 + static_cast<int>(random->index(40)), {}};
  const double share = std::pow(10.0, random->uniform(-3.0, 0.0));
  mask.cells.resize(static_cast<std::size_t>(mask.width * mask.height));
  for (std::uint8_t& cell : mask.cells) cell = random->uniform() < share ? 1 : 0;
  return mask;
}

std::vector<std::uint32_t> squaredDistances(const Mask& mask, int max_distance) {
  std::vector<std::uint32_t> all(mask.cells.size());
  DistanceTransform(mask.cells, mask.width, mask.height, max_distance)
      .forEachRow([&](const DistanceTransform::Row& row) {
        std::copy_n(row.squared, mask.width, all.begin() + static_cast<std::ptrdiff_t>(row.first));
      });
  return all;
}

std::uint32_t expectedDistance(const Mask& mask, int column, int row, int max_distance) {
  std::uint32_t nearest = DistanceTransform::kFar;
  for (int r = 0; r < mask.height; ++r) {
    for (int c = 0; c < mask.width; ++c) {
      const int squared = (c - column) * (c - column) + (r - row) * (r - row);
      if (mask.at(c, r) && squared <= max_distance * max_distance) {
        nearest = std::min(nearest, static_cast<std::uint32_t>(squared));
      }
    }
  }
  return nearest;
}

TEST(DistanceTransform, IsExactUpToTheMaximumDistance) {
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const Mask mask = randomMask(&random);
    const int max_distance = i % 2 == 0 ? 1000 : static_cast<int>(random.index(20));
    const std::vector<std::uint32_t> squared = squaredDistances(mask, max_distance);
    for (int row = 0; row < mask.height; ++row) {
      for (int column = 0; column < mask.width; ++column) {
        ASSERT_EQ(squared[static_cast<std::size_t>(row * mask.width + column)],
                  expectedDistance(mask, column, row, max_distance))
            << "mask " << i << ", column " << column << ", row " << row;
      }
    }
  }
}

TEST(DistanceTransform, EndsAtTheGreatestDistance) {
  constexpr int kWidth = DistanceTransform::kMaxDistance + 3;
  Mask line{kWidth, 1, std::vector<std::uint8_t>(kWidth)};
  line.cells[0] = 1;
  const std::vector<std::uint32_t> squared = squaredDistances(line, 1 << 20);
  EXPECT_EQ(squared[kWidth - 3], 32767U * 32767U);
  EXPECT_EQ(squared[kWidth - 2], DistanceTransform::kFar);
  EXPECT_EQ(squared[kWidth - 1], DistanceTransform::kFar);
}

TEST(DistanceTransform, ComputesTheRowsAskedFor) {
  const Mask mask{3, 4, {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
  const DistanceTransform distances(mask.cells, mask.width, mask.height);
  std::vector<int> rows(4);
  distances.forRows({1, 3}, [&](const DistanceTransform::Row& row) {
    rows[static_cast<std::size_t>(row.row)] = static_cast<int>(row.squared[2]);
    EXPECT_FLOAT_EQ(row.distance(2), std::sqrt(static_cast<float>(row.squared[2])));
  });
  EXPECT_EQ(rows, (std::vector<int>{0, 5, 0, 13}));
}

TEST(DistanceTransform, RejectsAMaskOfAnotherSize) {
  EXPECT_THROW(DistanceTransform({1, 0, 0}, 2, 2), std::invalid_argument);
  EXPECT_THROW(DistanceTransform({}, 0, 0), std::invalid_argument);
  EXPECT_THROW(dilated({1, 0, 0}, 2, 2, 1), std::invalid_argument);
}

TEST(Dilated, SetsTheSquareAroundEachCell) {
  Random random(2);
  for (int i = 0; i < 60; ++i) {
    const Mask mask = randomMask(&random);
    const int half = static_cast<int>(random.index(5));
    const std::vector<std::uint8_t> wide = dilated(mask.cells, mask.width, mask.height, half);
    for (int row = 0; row < mask.height; ++row) {
      for (int column = 0; column < mask.width; ++column) {
        bool expected = false;
        for (int r = row - half; r <= row + half; ++r) {
          for (int c = column - half; c <= column + half; ++c) expected |= mask.at(c, r);
        }
        ASSERT_EQ(wide[static_cast<std::size_t>(row * mask.width + column)], expected ? 1 : 0)
            << "mask " << i << ", column " << column << ", row " << row;
      }
    }
  }
}

TEST(WholeCells, AreRoundedUp) {
  EXPECT_EQ(wholeCells(2.0), 2);
  EXPECT_EQ(wholeCells(2.1), 3);
  EXPECT_EQ(wholeCells(1e9), DistanceTransform::kMaxDistance);
}

}  // namespace
}  // namespace racecar_mcl
