// The maps in maps/, and the script that draws them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "racecar_mcl/map/map_io.h"
#include "sim/world.h"
#include "support/temporary_directory.h"

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

TEST(DrawMaps, DrawsTheMapsThatAreKept) {
  if (std::system("python3 -c 'import numpy' 2> /dev/null") != 0)
    GTEST_SKIP() << "numpy is not installed";
  const TemporaryDirectory folder;
  const std::string drawn_maps = folder.path().string() + "/";
  ASSERT_EQ(
      std::system(("python3 " RACECAR_MCL_SOURCE_DIR "/tools/draw_maps " + drawn_maps).c_str()), 0);
  for (const std::string name : {"corridor", "corridor_world", "track", "track_world"}) {
    const OccupancyGrid drawn = loadMap(drawn_maps + name + ".yaml");
    const OccupancyGrid kept = loadMap(kMaps + name + ".yaml");
    ASSERT_EQ(drawn.cells().size(), kept.cells().size()) << name;
    int differing = 0;
    for (std::size_t i = 0; i < kept.cells().size(); ++i) {
      differing += drawn.cells()[i] != kept.cells()[i];
    }
    // With other numpy versions, beams along a cell border may end on either side.
    EXPECT_LE(differing, 20) << name;
    EXPECT_EQ(drawn.geometry().origin.x, kept.geometry().origin.x);
    EXPECT_EQ(drawn.geometry().origin.yaw, kept.geometry().origin.yaw);
  }
}

TEST(TrackMap, HasAnOriginYaw) {
  EXPECT_NEAR(loadMap(kMaps + "track.yaml").geometry().origin.yaw, 0.3, 1e-12);
}

}  // namespace
}  // namespace racecar_mcl::sim
