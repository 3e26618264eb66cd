#include "sim/racing_path.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "racecar_mcl/common/errors.h"
#include "support/ascii_map.h"
#include "support/ring_map.h"

namespace racecar_mcl::sim {
namespace {

TEST(RacingPath, IsTheInnermostCircleOfARing) {
  const Path path = racingPath(ringMap(3.0, 6.0), circle(4.0, 40), 0.5);
  for (const Eigen::Vector2d& point : path) {
    EXPECT_GT(point.norm(), 3.5);
    EXPECT_LT(point.norm(), 3.65);
  }
  EXPECT_NEAR((path[1] - path[0]).norm(), 0.1, 0.02);
}

TEST(RacingPath, PassesAPillarOnTheSideOfTheLap) {
  const OccupancyGrid map = asciiMap(R"(
      ####################
      #..................#
      #..................#
      #..................#
      #.........#........#
      #..................#
      #..................#
      #..................#
      #....##########....#
      #....##########....#
      #....##########....#
      #..................#
      #..................#
      #..................#
      #..................#
      ####################)",
                                     0.5);
  for (const double pass_y : {4.75, 6.75}) {
    const Path lap{{1.5, 1.5}, {8.25, 1.5}, {8.25, pass_y}, {1.5, pass_y}};
    const Path path = racingPath(map, lap, 0.2);
    const bool is_above = std::any_of(path.begin(), path.end(), [](const Eigen::Vector2d& point) {
      return std::abs(point.x() - 5.25) < 0.2 && point.y() > 6.0;
    });
    const bool is_below = std::any_of(path.begin(), path.end(), [](const Eigen::Vector2d& point) {
      return std::abs(point.x() - 5.25) < 0.2 && point.y() > 4.0 && point.y() < 5.5;
    });
    EXPECT_EQ(is_above, pass_y > 6.0);
    EXPECT_NE(is_below, is_above);
  }
}

TEST(RacingPath, IsRefusedInANarrowCorridor) {
  EXPECT_THROW(racingPath(ringMap(4.5, 5.2), circle(4.85, 60), 0.44), MapError);
}

TEST(RacingPath, IsRefusedForAShortLap) {
  EXPECT_THROW(racingPath(ringMap(0.2, 3.0), circle(0.7, 20), 0.1), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
