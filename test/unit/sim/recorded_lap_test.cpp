#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "sim/recorded_drive.h"
#include "support/analytic_room.h"
#include "support/ring_map.h"

namespace racecar_mcl::sim {
namespace {

TEST(RecordLap, FollowsTheCorridorOnceAround) {
  const auto world = std::make_shared<const World>(ringMap(3.0, 5.0));
  const Path lap = recordLap(world, {0.0, -4.0, 0.0});
  EXPECT_LT((lap.front() - Eigen::Vector2d(0.0, -4.0)).norm(), 0.01);
  EXPECT_LT((lap.back() - lap.front()).norm(), 0.3);
  double turned = 0.0;
  for (std::size_t i = 1; i < lap.size(); ++i) {
    EXPECT_NEAR(lap[i].norm(), 4.0, 0.4);
    turned +=
        wrapAngle(std::atan2(lap[i].y(), lap[i].x()) - std::atan2(lap[i - 1].y(), lap[i - 1].x()));
  }
  EXPECT_NEAR(turned, 2.0 * kPi, 0.1);
}

TEST(RecordLap, IsRefusedWhereThereIsNone) {
  const auto world = std::make_shared<const World>(Room{3.0, 1.0}.grid());
  EXPECT_THROW(recordLap(world, {1.5, 0.5, 0.0}), MapError);
}

}  // namespace
}  // namespace racecar_mcl::sim
