// The script that draws the maps in maps/ and random courses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "racecar_mcl/map/map_io.h"
#include "sim/world.h"
#include "support/temporary_directory.h"

namespace racecar_mcl::sim {
namespace {

class DrawMaps : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("python3 -c 'import numpy' 2> /dev/null") != 0)
      GTEST_SKIP() << "numpy is not installed";
  }

  /// The folder of the maps, with a slash.
  std::string draw(const std::string& options) {
    const std::string command = "python3 " RACECAR_MCL_SOURCE_DIR "/tools/draw_maps ";
    const std::string maps = folder_.path().string() + "/";
    EXPECT_EQ(std::system((command + options + " " + maps).c_str()), 0);
    return maps;
  }

 private:
  TemporaryDirectory folder_;
};

TEST_F(DrawMaps, DrawsTheMapsThatAreKept) {
  const std::string drawn_maps = draw("");
  for (const std::string name : {"corridor", "corridor_world", "track", "track_world"}) {
    const OccupancyGrid drawn = loadMap(drawn_maps + name + ".yaml");
    const OccupancyGrid kept = loadMap(RACECAR_MCL_SOURCE_DIR "/maps/" + name + ".yaml");
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

TEST_F(DrawMaps, DrawsRandomCoursesThatACarCanDriveOn) {
  const std::string maps = draw("--random 3 --seed 6");
  for (const std::string name : {"course_6_plain", "course_7_solid", "course_8_slam"}) {
    const std::string map_path = maps + name + ".yaml";
    const OccupancyGrid map = loadMap(map_path);
    const World world(loadMap(worldPathFor(map_path)));
    const Pose2 start = requireStartPose(map_path);
    EXPECT_GT(world.castWalls({start.x, start.y}, start.yaw, 10.0), 2.0) << name;
    for (const double side : {-M_PI_2, M_PI_2}) {
      EXPECT_GT(world.castWalls({start.x, start.y}, start.yaw + side, 10.0), 0.9) << name;
    }
    EXPECT_GT(world.freeArea(), 50.0) << name;
    const auto unknown = std::count(map.cells().begin(), map.cells().end(), -1);
    EXPECT_EQ(unknown == 0, name == "course_7_solid");
  }
}

TEST_F(DrawMaps, DrawsACourseAgainWithOtherCells) {
  const std::string name = "course_6_plain.yaml";
  const OccupancyGrid first = loadMap(draw("--random 1 --seed 6") + name);
  const OccupancyGrid second = loadMap(draw("--random 1 --seed 6") + name);
  EXPECT_EQ(first.cells(), second.cells());
  const OccupancyGrid coarse = loadMap(draw("--random 1 --seed 6 --cell 0.1") + name);
  EXPECT_NEAR(coarse.geometry().resolution, 0.1, 1e-12);
  EXPECT_NEAR(coarse.geometry().width, first.geometry().width / 2, 1);
}

}  // namespace
}  // namespace racecar_mcl::sim
