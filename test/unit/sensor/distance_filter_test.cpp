#include "racecar_mcl/sensor/distance_filter.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/single_wall.h"

namespace racecar_mcl {
namespace {

/// 12 beams that end at the wall.
class DistanceFilterTest : public WallAhead {
 protected:
  DistanceFilterTest() { beams_.ranges /= beams_.bearings.cos(); }

  Scan kept(Eigen::Index least = 1) {
    return withoutShortReturns(map_->view(), car_, beams_, least);
  }

  Scan beams_ = beamsAhead(12, 3.05f);
};

TEST_F(DistanceFilterTest, RejectsBeamsThatEndInFreeSpaceBeforeAWall) {
  beams_.ranges.segment(4, 3) = 1.2f;
  const Scan scan = kept();
  ASSERT_EQ(scan.size(), 9);
  EXPECT_TRUE((scan.ranges > 3.0f).all());
  EXPECT_TRUE((scan.bearings.head(4) == beams_.bearings.head(4)).all());
  EXPECT_TRUE((scan.bearings.tail(5) == beams_.bearings.tail(5)).all());
}

TEST_F(DistanceFilterTest, KeepsBeamsThatEndAtOrBehindTheWallOrHaveNoReturn) {
  beams_.ranges[0] = 2.7f;
  beams_.ranges[1] = 3.4f;
  beams_.ranges[2] = 8.0f;
  beams_.ranges[3] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(kept().size(), 12);
}

TEST_F(DistanceFilterTest, KeepsABeamThatHitsACorner) {
  // The expected ray passes the corner of the opening and the beam ends on it.
  map_ = makeLocalizationMap(asciiMap(R"(
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
  EXPECT_EQ(withoutShortReturns(map_->view(), {8.0, 4.1, 0.0}, beams_, 1).size(), 12);
}

TEST_F(DistanceFilterTest, KeepsAllIfMostAreShortOrFewWouldRemain) {
  beams_.ranges.head(6) = 1.2f;
  EXPECT_EQ(kept().size(), 6);
  EXPECT_EQ(kept(7).size(), 12);
  beams_.ranges.head(7) = 1.2f;
  EXPECT_EQ(kept().size(), 12) << "the pose is wrong";
}

}  // namespace
}  // namespace racecar_mcl
