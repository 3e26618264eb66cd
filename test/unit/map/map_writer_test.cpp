#include "racecar_mcl/map/map_writer.h"

#include <gtest/gtest.h>

#include "racecar_mcl/map/map_io.h"
#include "sim/map_faults.h"
#include "support/ascii_map.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

OccupancyGrid writtenAndRead(const OccupancyGrid& map, MapMode mode) {
  const TemporaryDirectory folder;
  folder.write("map.pgm", toPgm(map, mode));
  return loadMap(folder.write("map.yaml", toMapYaml(map.geometry(), "map.pgm", mode)));
}

TEST(MapWriter, TheRawModeKeepsAllValues) {
  const OccupancyGrid track = loadMap(RACECAR_MCL_SOURCE_DIR "/maps/track.yaml");
  Random random(1);
  for (const OccupancyGrid& map : {track, sim::greyCells(track, random), sim::fillUnknown(track)}) {
    const OccupancyGrid read = writtenAndRead(map, MapMode::kRaw);
    EXPECT_EQ(read.cells(), map.cells());
    EXPECT_EQ(read.geometry().width, map.geometry().width);
    EXPECT_EQ(read.geometry().resolution, map.geometry().resolution);
    EXPECT_EQ(read.geometry().origin.x, map.geometry().origin.x);
    EXPECT_EQ(read.geometry().origin.yaw, map.geometry().origin.yaw);
  }
}

TEST(MapWriter, TheTrinaryModeKeepsFreeOccupiedAndUnknown) {
  const std::string drawn = "#.?\n..#\n";
  EXPECT_EQ(toAscii(writtenAndRead(asciiMap("#.?\n..#"), MapMode::kTrinary)), drawn);
  const OccupancyGrid track = loadMap(RACECAR_MCL_SOURCE_DIR "/maps/track.yaml");
  EXPECT_EQ(writtenAndRead(track, MapMode::kTrinary).cells(), track.cells());
}

}  // namespace
}  // namespace racecar_mcl
