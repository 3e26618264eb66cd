#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "support/program.h"

namespace racecar_mcl {
namespace {

/// 20 x 12 cells of 0.1 m: free space inside walls of two or three cells with an opening in the
/// right wall, unknown outside.
class MapCheckProgram : public testing::Test {
 protected:
  std::string writeMap(const std::string& name, const std::string& pixels) {
    folder_.write(name + ".pgm", "P5\n20 12\n255\n" + pixels);
    return folder_.write(name + ".yaml",
                         "image: " + name +
                             ".pgm\nresolution: 0.1\norigin: [-1.0, 2.0, 0.3]\nnegate: 0\n"
                             "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  }

  static std::string roomPixels() {
    std::string pixels;
    for (int row = 0; row < 12; ++row) {
      for (int column = 0; column < 20; ++column) {
        const bool inside = column >= 4 && column < 15 && row >= 4 && row < 9;
        const bool walled = column >= 1 && column < 18 && row >= 1 && row < 11;
        const bool gap = column >= 15 && row == 6;
        pixels += static_cast<char>(inside ? 254 : walled && !gap ? 0 : 205);
      }
    }
    return pixels;
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryDirectory folder_;
};

TEST_F(MapCheckProgram, SaysWhatTheMapIs) {
  const ProgramResult result = runProgram(MAP_CHECK_PROGRAM, {writeMap("room", roomPixels())});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out,
            "map of 20 x 12 cells at 0.1 m, 2.0 x 1.2 m: filled map (solid outside), 0.6 m2 free, "
            "3.1 m of surfaces\n"
            "  origin    x -1.000 m, y 2.000 m, yaw 0.300 rad\n"
            "  cells     22.9 % free, 46.7 % occupied, 30.4 % unknown\n"
            "  free      0.6 m2; areas larger than 0.5 m2: 1, the largest has 100.0 %\n"
            "  surfaces  31 cells, about 3.1 m\n"
            "  blurred   0.0 m2 of walls; of the surfaces 0.0 %\n"
            "  hidden    72.3 % of the obstacle cells\n"
            "  openings  3.1 % of the border of free space\n");
}

TEST_F(MapCheckProgram, LocalizabilityMarksBlindPlaces) {
  const std::string map = writeMap("room", roomPixels());
  const ProgramResult result = runProgram(
      LOCALIZABILITY_PROGRAM, {map, "--spacing", "0.1", "--blind", "0.5", "--out", path("l.png")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("blind (over 50.0 cm): 0.0 % of 55 places"), std::string::npos)
      << result.out;
  EXPECT_FALSE(cv::imread(path("l.png")).empty());
  const ProgramResult blind =
      runProgram(LOCALIZABILITY_PROGRAM, {map, "--spacing", "0.1", "--blind", "0.0001"});
  EXPECT_NE(blind.out.find("100.0 % of 55 places"), std::string::npos) << blind.out;
  EXPECT_EQ(runProgram(LOCALIZABILITY_PROGRAM, {map, "--spacing", "0"}).exit_code, 1);
  EXPECT_EQ(runProgram(LOCALIZABILITY_PROGRAM, {path("none.yaml")}).exit_code, 1);
}

TEST_F(MapCheckProgram, DrawsWhatALidarSees) {
  const ProgramResult result =
      runProgram(MAP_CHECK_PROGRAM, {writeMap("room", roomPixels()), "--out", path("picture.png")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const cv::Mat picture = cv::imread(path("picture.png"), cv::IMREAD_COLOR);
  ASSERT_FALSE(picture.empty());
  // 40 pixels per cell and the legend below.
  EXPECT_EQ(picture.cols, 20 * 40);
  EXPECT_EQ(picture.rows, 12 * 40 + 30);
  const auto cell = [&](int column, int image_row) {
    return picture.at<cv::Vec3b>(40 * image_row + 20, 40 * column + 20);
  };
  EXPECT_EQ(cell(8, 6), cv::Vec3b(255, 255, 255)) << "free";
  EXPECT_EQ(cell(0, 0), cv::Vec3b(205, 205, 205)) << "unknown";
  EXPECT_EQ(cell(3, 5), cv::Vec3b(0, 0, 0)) << "surface";
  EXPECT_EQ(cell(8, 3), cv::Vec3b(0, 0, 0)) << "surface";
  EXPECT_EQ(cell(8, 2), cv::Vec3b(110, 110, 110)) << "hidden";
  EXPECT_EQ(cell(8, 10), cv::Vec3b(110, 110, 110)) << "hidden";
  EXPECT_EQ(cell(14, 6), cv::Vec3b(230, 90, 0)) << "opening";
  EXPECT_EQ(cell(14, 5), cv::Vec3b(255, 255, 255)) << "free, beside the opening";
}

TEST_F(MapCheckProgram, DrawsBlurredWalls) {
  // A wall of 0.7 m.
  const std::string pixels = std::string(20, static_cast<char>(205)) + std::string(20 * 7, 0) +
                             std::string(20 * 4, static_cast<char>(254));
  const std::string map = writeMap("blurred", pixels);
  const ProgramResult result = runProgram(MAP_CHECK_PROGRAM, {map, "--out", path("picture.png")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("warning: 100 % of the surfaces are of blurred walls"),
            std::string::npos)
      << result.out;
  const cv::Mat picture = cv::imread(path("picture.png"), cv::IMREAD_COLOR);
  ASSERT_FALSE(picture.empty());
  EXPECT_EQ(picture.at<cv::Vec3b>(40 * 6 + 20, 420), cv::Vec3b(0, 140, 255));
  EXPECT_EQ(picture.at<cv::Vec3b>(40 * 7 + 20, 420), cv::Vec3b(0, 0, 0));
}

TEST_F(MapCheckProgram, WarnsAndStillSucceeds) {
  const std::string map = writeMap("room", roomPixels());
  std::string coarse = readWhole(map);
  coarse.replace(coarse.find("0.1\n"), 3, "0.2");
  const ProgramResult result =
      runProgram(MAP_CHECK_PROGRAM, {folder_.write("coarse.yaml", coarse)});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("\nwarning: cells of 0.2 m are coarse"), std::string::npos)
      << result.out;
}

TEST_F(MapCheckProgram, FailsWhereALocalizerCannotUseTheMap) {
  for (const int pixel : {0, 205, 254}) {
    const std::string map = writeMap("plain", std::string(20 * 12, static_cast<char>(pixel)));
    const ProgramResult result = runProgram(MAP_CHECK_PROGRAM, {map, "--out", path("plain.png")});
    EXPECT_EQ(result.exit_code, 1) << pixel;
    EXPECT_NE(result.out.find("warning: no "), std::string::npos) << result.out;
    EXPECT_EQ(result.err, "map_check: error: " + map + ": the localizer cannot use this map\n");
    EXPECT_FALSE(cv::imread(path("plain.png")).empty()) << pixel;
  }
}

TEST_F(MapCheckProgram, SaysWhatIsWrongWithItsFiles) {
  const ProgramResult none = runProgram(MAP_CHECK_PROGRAM, {});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.err.find("map is required"), std::string::npos) << none.err;
  const ProgramResult missing = runProgram(MAP_CHECK_PROGRAM, {"/no/such/map.yaml"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("'/no/such/map.yaml' does not exist"), std::string::npos)
      << missing.err;
  const ProgramResult bad =
      runProgram(MAP_CHECK_PROGRAM, {folder_.write("bad.yaml", "resolution: 0.1\n")});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_NE(bad.err.find("lacks the key 'image'"), std::string::npos) << bad.err;
  const std::string map = writeMap("room", roomPixels());
  for (const char* out : {"/no/such/folder/picture.png", "/tmp/picture_without_ending"}) {
    const ProgramResult result = runProgram(MAP_CHECK_PROGRAM, {map, "--out", out});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.err.find(std::string("map_check: error: ") + out), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  const ProgramResult help = runProgram(MAP_CHECK_PROGRAM, {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("MAP.yaml"), std::string::npos) << help.out;
}

}  // namespace
}  // namespace racecar_mcl
