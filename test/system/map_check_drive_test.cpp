// map_check over a recorded drive: the room's bag on maps of other rooms.
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "racecar_mcl/map/map_io.h"
#include "support/program.h"
#include "support/room_folder.h"

namespace racecar_mcl {
namespace {

using Arguments = std::vector<std::string>;

class MapCheckDrive : public RoomFolder {
 protected:
  MapCheckDrive() { writeRoomBag(path("drive.bag"), {}); }

  ProgramResult check(const std::string& map, Arguments arguments,
                      const std::string& start = "0.8 1.0 0.1") const {
    arguments.insert(arguments.begin(),
                     {"--bag", path("drive.bag"), "--map", map, "--initial-pose", start});
    return runProgram(MAP_CHECK_PROGRAM, arguments);
  }

  /// The room with a block around (3.1, 3.0) and without the corner at the upper right, at which
  /// the room of the bag ends.
  std::string writeOldMap() {
    std::string pgm = roomPgm();
    const auto fill = [&](double x, double y, double width, double height, int value) {
      for (int row = cellOf(y); row < cellOf(y + height); ++row) {
        for (int column = cellOf(x); column < cellOf(x + width); ++column) {
          pgm[pgm.size() - static_cast<std::size_t>((row + 1) * 122 - column)] =
              static_cast<char>(value);
        }
      }
    };
    fill(2.9, 2.8, 0.4, 0.4, 0);
    fill(4.5, 3.0, 1.5, 1.0, 254);
    folder_.write("old.pgm", pgm);
    std::string yaml = roomYaml();
    yaml.replace(yaml.find("room"), 4, "old");
    return folder_.write("old.yaml", yaml);
  }

  static int cellOf(double metres) {
    return static_cast<int>(std::lround(metres / kRoomResolution)) + 1;
  }
};

TEST_F(MapCheckDrive, PrintsAndProposesWhatChanged) {
  const std::string map = writeOldMap();
  const ProgramResult result = check(map, {"--output", path("new")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("scans compared with the map\ncells: "), std::string::npos)
      << result.out;
  const std::string csv = readWhole(path("new/changes.csv"));
  EXPECT_NE(csv.find(",new,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",gone,3."), std::string::npos) << csv;
  EXPECT_EQ(cv::imread(path("new/changes.png")).cols, 122 * 10);

  const OccupancyGrid before = loadMap(map);
  const OccupancyGrid proposed = loadMap(path("new/map.yaml"));
  EXPECT_EQ(proposed.geometry().width, before.geometry().width);
  EXPECT_EQ(proposed.geometry().resolution, before.geometry().resolution);
  EXPECT_EQ(proposed.geometry().origin.x, before.geometry().origin.x);
  EXPECT_TRUE(proposed.isFree({cellOf(3.1), cellOf(3.0)})) << "the block";
  int corner = 0;
  for (double y = 3.1; y < 3.9; y += kRoomResolution) {
    for (int offset = -1; offset <= 2; ++offset) {
      if (proposed.at({cellOf(4.5) + offset, cellOf(y)}) != OccupancyGrid::kOccupied) continue;
      ++corner;
      break;
    }
  }
  EXPECT_GE(corner, 14) << "of 16 cells of the corner's side";
}

TEST_F(MapCheckDrive, FindsNothingOnTheMapOfTheRoom) {
  const ProgramResult result = check(map_, {});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("no region changed\n"), std::string::npos) << result.out;
}

TEST_F(MapCheckDrive, ProposesNothingIfTheCarWasNotLocalized) {
  const auto expect_nothing = [&](const Arguments& arguments, const std::string& start) {
    const ProgramResult result = check(map_, arguments, start);
    EXPECT_EQ(result.exit_code, 1) << start;
    EXPECT_NE(result.err.find("no map is proposed"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(path("new"))) << start;
  };
  expect_nothing({"--duration", "0.05", "--output", path("new")}, "0.8 1.0 0.1");
  expect_nothing({"--set", "relocalization:=off", "--output", path("new")}, "3.0 2.0 2.0");
}

TEST_F(MapCheckDrive, NamesWhatIsWrong) {
  const auto expect_error = [](const ProgramResult& result, const std::string& words) {
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.err.find("map_check: error: "), 0u) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  };
  expect_error(runProgram(MAP_CHECK_PROGRAM, {map_, "--bag", path("none.bag")}), "none.bag");
  expect_error(runProgram(MAP_CHECK_PROGRAM, {map_, "--output", path("new")}), "--bag");
  expect_error(check(map_, {"--out", path("picture.png")}), "--out");
  // The proposal would replace the map.
  std::string yaml = roomYaml();
  const std::string map = folder_.write("map.yaml", yaml);
  expect_error(check(map, {"--output", folder_.path().string()}), "would replace the input");
  EXPECT_EQ(readWhole(map), yaml);
}

}  // namespace
}  // namespace racecar_mcl
