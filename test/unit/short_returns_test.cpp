#include "racecar_mcl/short_returns.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/wall_ahead.h"

namespace racecar_mcl {
namespace {

/// 12 beams that end at the wall.
class ShortReturns : public WallAhead {
 protected:
  ShortReturns() { beams_.ranges /= beams_.bearings.cos(); }

  Scan kept(Eigen::Index least = 1) { return withoutShortReturns(map_.get(), car_, beams_, least); }

  Scan beams_ = beamsAhead(12, 3.05f);
};

TEST_F(ShortReturns, LeavesOutWhatEndsInFreeSpaceBeforeAWall) {
  beams_.ranges.segment(4, 3) = 1.2f;
  const Scan scan = kept();
  ASSERT_EQ(scan.size(), 9);
  EXPECT_TRUE((scan.ranges > 3.0f).all());
  EXPECT_TRUE((scan.bearings.head(4) == beams_.bearings.head(4)).all());
  EXPECT_TRUE((scan.bearings.tail(5) == beams_.bearings.tail(5)).all());
}

TEST_F(ShortReturns, KeepsWhatEndsAtTheWallOrBehindItOrNowhere) {
  beams_.ranges[0] = 2.7f;
  beams_.ranges[1] = 3.4f;
  beams_.ranges[2] = 8.0f;
  beams_.ranges[3] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(kept().size(), 12);
}

TEST_F(ShortReturns, KeepsABeamThatBrushesACorner) {
  // The pose looks past the corner of the room's opening and the beam ends on it.
  map_ = makeMapModel(asciiMap(R"(
      ####################
      #..................#
      #..................#
      #..................#
      #.........##########
      #..................#
      #..................#
      ####################)"),
                      SensorParameters{});
  // From (8, 4.1) along x: just above the block that begins at (10, 4).
  for (Eigen::Index k = 0; k < 12; ++k) beams_.ranges[k] = 2.3f;
  beams_.bearings.setConstant(0.02f);
  EXPECT_EQ(withoutShortReturns(map_.get(), {8.0, 4.1, 0.0}, beams_, 1).size(), 12);
}

TEST_F(ShortReturns, KeepsAllWhereMostAreShortOrFewWouldStay) {
  beams_.ranges.head(6) = 1.2f;
  EXPECT_EQ(kept().size(), 6);
  EXPECT_EQ(kept(7).size(), 12);
  beams_.ranges.head(7) = 1.2f;
  EXPECT_EQ(kept().size(), 12) << "then it is the pose that is wrong";
}

}  // namespace
}  // namespace racecar_mcl
