// The maps in maps/.
#include <gtest/gtest.h>

#include <string>

#include "racecar_mcl/map/map_io.h"

namespace racecar_mcl::sim {
namespace {

const std::string kMaps = RACECAR_MCL_SOURCE_DIR "/maps/";

class OurMaps : public testing::TestWithParam<const char*> {};

TEST_P(OurMaps, AreWallsWhereTheWorldsWallsAre) {
  const OccupancyGrid map = loadMap(kMaps + GetParam() + ".yaml");
  const OccupancyGrid world = loadMap(kMaps + GetParam() + "_world.yaml");
  ASSERT_EQ(world.geometry().width, 5 * map.geometry().width);
  ASSERT_EQ(world.geometry().height, 5 * map.geometry().height);
  EXPECT_NEAR(map.geometry().resolution, 0.05, 1e-12);
  int mostly_wall = 0, drawn = 0;
  for (int row = 0; row < map.geometry().height; ++row) {
    for (int column = 0; column < map.geometry().width; ++column) {
      int wall = 0;  // fine cells of the 25
      for (int k = 0; k < 25; ++k) {
        wall += world.at({5 * column + k % 5, 5 * row + k / 5}) == OccupancyGrid::kOccupied;
      }
      if (map.at({column, row}) == OccupancyGrid::kOccupied) {
        ASSERT_GT(wall, 0) << column << ", " << row;
      } else {
        ASSERT_LT(wall, 25) << column << ", " << row;
      }
      // Cells that are partly wall must stop most beams.
      if (wall >= 15) {
        ++mostly_wall;
        drawn += map.at({column, row}) == OccupancyGrid::kOccupied;
      }
    }
  }
  EXPECT_GT(drawn, 0.98 * mostly_wall);
}

INSTANTIATE_TEST_SUITE_P(Places, OurMaps, testing::Values("corridor", "track"));

TEST(TrackMap, HasAnOriginYaw) {
  EXPECT_NEAR(loadMap(kMaps + "track.yaml").geometry().origin.yaw, 0.3, 1e-12);
}

}  // namespace
}  // namespace racecar_mcl::sim
