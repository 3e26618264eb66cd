#include "racecar_mcl/map/map_summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

MapSummary summaryOf(const OccupancyGrid& grid) { return summarize(grid); }

MapSummary summaryOf(const std::string& drawing, double resolution = 0.1) {
  return summaryOf(asciiMap(drawing, resolution));
}

int warningsWith(const std::string& words, const MapSummary& summary) {
  return static_cast<int>(
      std::count_if(summary.warnings.begin(), summary.warnings.end(),
                    [&](const auto& line) { return line.find(words) != std::string::npos; }));
}

std::string lines(const MapSummary& summary) {
  std::string text;
  for (const std::string& line : summary.warnings) text += line + "\n";
  return text;
}

/// A grid of one value in which some cells have another one.
OccupancyGrid filledGrid(int width, int height, double resolution, std::int8_t value) {
  return OccupancyGrid({width, height, resolution, {}},
                       std::vector<std::int8_t>(static_cast<std::size_t>(width * height), value));
}

constexpr char kSlamRoom[] = R"(
    ????????????
    ?##########?
    ?#........#?
    ?#........#?
    ?#........#?
    ?#........#?
    ?#........#?
    ?#........#?
    ?##########?
    ????????????)";

constexpr char kFilledRoom[] = R"(
    ############
    ############
    ##........##
    ##........##
    ##........##
    ##........##
    ##........##
    ##........##
    ############
    ############)";

TEST(MapSummary, CountsCellsAndMeasuresThem) {
  const MapSummary s = summaryOf(kSlamRoom);
  EXPECT_EQ(s.kind, MapKind::kSlam);
  EXPECT_TRUE(s.usable());
  EXPECT_NEAR(s.free_share, 48.0 / 120.0, 1e-12);
  EXPECT_NEAR(s.occupied_share, 32.0 / 120.0, 1e-12);
  EXPECT_NEAR(s.unknown_share, 40.0 / 120.0, 1e-12);
  EXPECT_NEAR(s.free_area, 0.48, 1e-12);
  EXPECT_NEAR(s.largest_free_area, 0.48, 1e-12);
  EXPECT_EQ(s.free_cells_at_border, 0u);
  // The four corners touch no free cell.
  EXPECT_EQ(s.surface_cells, 28u);
  EXPECT_NEAR(s.surface_length, 2.8, 1e-12);
  EXPECT_NEAR(s.hidden_share, 4.0 / 32.0, 1e-12);
  EXPECT_EQ(s.blurred_area, 0.0);
  EXPECT_EQ(s.opening_share, 0.0);
  EXPECT_TRUE(s.warnings.empty()) << lines(s);
}

TEST(MapSummary, IsDescribedInALineThatStartsWithTheSize) {
  EXPECT_EQ(describe(summaryOf(kSlamRoom)),
            "map of 12 x 10 cells at 0.1 m, 1.2 x 1.0 m: SLAM map (unknown outside), 0.5 m2 free, "
            "2.8 m of surfaces");
}

TEST(MapSummary, KeepsTheGeometry) {
  const MapSummary s = summaryOf(asciiMap(kSlamRoom, 0.1, {-3.0, 2.0, 0.3}));
  EXPECT_EQ(s.geometry.width, 12);
  EXPECT_EQ(s.geometry.height, 10);
  EXPECT_EQ(s.geometry.origin.x, -3.0);
  EXPECT_EQ(s.geometry.origin.y, 2.0);
  EXPECT_EQ(s.geometry.origin.yaw, 0.3);
}

TEST(MapSummary, DistinguishesKindsByTheOutside) {
  EXPECT_EQ(summaryOf(kFilledRoom).kind, MapKind::kFilled);
  EXPECT_EQ(summaryOf(R"(
      ..........
      ..######..
      ..#....#..
      ..#....#..
      ..######..
      ..........)")
                .kind,
            MapKind::kOpen);
  OccupancyGrid walls = filledGrid(60, 60, 0.05, OccupancyGrid::kFree);
  std::vector<std::int8_t> cells = walls.cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i % 60 == 0 || i % 60 == 59 || i < 60 || i >= 59 * 60) cells[i] = OccupancyGrid::kOccupied;
  }
  EXPECT_EQ(summaryOf(OccupancyGrid(walls.geometry(), cells)).kind, MapKind::kWalls);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i % 7 == 0) cells[i] = cells[i] == OccupancyGrid::kFree ? 20 : 80;
  }
  EXPECT_EQ(summaryOf(OccupancyGrid(walls.geometry(), cells)).kind, MapKind::kGrey);
}

TEST(MapSummary, AFilledMapHidesMostOfItsObstacles) {
  const MapSummary s = summaryOf(kFilledRoom, 0.05);
  EXPECT_EQ(s.surface_cells, 28u);
  EXPECT_NEAR(s.hidden_share, 44.0 / 72.0, 1e-12);
  EXPECT_TRUE(s.warnings.empty()) << lines(s);
}

TEST(MapSummary, CannotBeUsedWithoutFreeCellsOrObstacles) {
  const MapSummary solid = summaryOf("###\n###"), unknown = summaryOf("???");
  EXPECT_EQ(solid.kind, MapKind::kNoFreeCells);
  EXPECT_EQ(unknown.kind, MapKind::kNoFreeCells);
  EXPECT_FALSE(solid.usable());
  EXPECT_EQ(warningsWith("no free cell", solid), 1) << lines(solid);
  EXPECT_EQ(warningsWith("no obstacle cell", unknown), 1) << lines(unknown);
  const MapSummary empty = summaryOf("...\n...");
  EXPECT_EQ(empty.kind, MapKind::kNoObstacles);
  EXPECT_FALSE(empty.usable());
  EXPECT_EQ(warningsWith("no obstacle cell", empty), 1) << lines(empty);
  EXPECT_NE(describe(empty).find("map without obstacles"), std::string::npos);
}

TEST(MapSummary, WarnsIfNoObstacleIsNextToFreeSpace) {
  const MapSummary s = summaryOf("##???..\n##???..");
  EXPECT_EQ(s.surface_cells, 4u);
  EXPECT_EQ(warningsWith("no obstacle is next to free space", s), 1) << lines(s);
  EXPECT_EQ(warningsWith("no obstacle is next to free space", summaryOf(kSlamRoom)), 0);
}

TEST(MapSummary, CountsSeparateFreeAreasWithoutSpecks) {
  // Cells of 0.5 m: one cell is 0.25 m^2, four are 1 m^2. Corners do not connect.
  const MapSummary s = summaryOf(R"(
      ###########
      #....#..#.#
      #....#..###
      #....###..#
      #....###..#
      ###########)",
                                 0.5);
  EXPECT_EQ(s.free_areas, 3);
  EXPECT_NEAR(s.largest_free_area, 4.0, 1e-12);
  EXPECT_NEAR(s.free_area, 6.25, 1e-12);
  EXPECT_EQ(warningsWith("3 separate areas, the largest 64 %", s), 1) << lines(s);
  EXPECT_EQ(warningsWith("coarse: expected 0.15 m or less", s), 1) << lines(s);
}

TEST(MapSummary, WarnsOfFreeSpaceAtTheBorderOfTheImage) {
  const MapSummary s = summaryOf(R"(
      ########
      #.......
      #.......
      #.......
      ########)",
                                 0.2);
  EXPECT_EQ(s.free_cells_at_border, 3u);
  EXPECT_EQ(warningsWith("reaches the border of the image along 0.6 m", s), 1) << lines(s);
  EXPECT_NEAR(s.opening_share, 3.0 / 20.0, 1e-12);
}

TEST(MapSummary, OpeningsAreTheUnknownInTheBorderOfFreeSpace) {
  const MapSummary s = summaryOf(R"(
      ??????????
      ?########?
      ?#......??
      ?#......??
      ?#......??
      ?#......??
      ?########?
      ??????????)",
                                 0.2);
  EXPECT_NEAR(s.opening_share, 4.0 / 20.0, 1e-12);
  EXPECT_EQ(warningsWith("unknown instead of a wall", s), 0) << lines(s);
  const MapSummary half = summaryOf(R"(
      ??????????
      ?########?
      ?#......??
      ?#......??
      ?#......??
      ?#......??
      ??????????
      ??????????)",
                                    0.2);
  EXPECT_NEAR(half.opening_share, 10.0 / 20.0, 1e-12);
  EXPECT_EQ(warningsWith("50 % of the border of free space is unknown", half), 1) << lines(half);
}

TEST(MapSummary, SmoothedWallsSpecksAndSingleBeamsAreNoOpenings) {
  const char* drawing = R"(
      ????????????????
      ????????????????
      ?????########???
      ???????????????.
      ???##......#??.?
      ???##......???.?
      ???##..?...##?.?
      ???##......#??.?
      ???##......#??.?
      ???#########???.
      ????????????????)";
  const OccupancyGrid grid = asciiMap(drawing, 0.1);
  const MapSummary s = summaryOf(grid);
  // The upper wall is behind a row of unknown cells, the right one has one cell of an opening; the
  // strip of a single cell outside is neither wall nor opening.
  EXPECT_NEAR(s.opening_share, 1.0 / 22.0, 1e-12);
  const std::vector<std::uint8_t> openings = findOpenings(grid);
  std::string marked;
  for (int column = 0; column < 16; ++column) {
    for (int row = 0; row < 11; ++row) {
      if (openings[static_cast<std::size_t>(16 * row + column)] != 0) {
        marked += std::to_string(column) + "," + std::to_string(row) + " ";
      }
    }
  }
  EXPECT_EQ(marked, "10,5 ");
}

TEST(MapSummary, MeasuresBlurredWalls) {
  // A free strip between two walls of 0.8 m, cells of 0.1 m.
  std::vector<std::int8_t> cells;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 40; ++column) {
      const bool free = row >= 20 && row < 40, wall = !free && row >= 12 && row < 48;
      cells.push_back(free   ? OccupancyGrid::kFree
                      : wall ? OccupancyGrid::kOccupied
                             : OccupancyGrid::kUnknown);
    }
  }
  const MapSummary s = summaryOf(OccupancyGrid({40, 60, 0.1, {}}, std::move(cells)));
  EXPECT_NEAR(s.blurred_area, 2 * 4.0 * 0.8, 1e-9);
  EXPECT_EQ(s.surface_cells, 80u);
  EXPECT_EQ(s.blurred_surface_share, 1.0);
  EXPECT_EQ(s.hidden_share, 0.0);
  EXPECT_EQ(warningsWith("100 % of the surfaces are of blurred walls", s), 1) << lines(s);
}

TEST(MapSummary, HandlesGridsOfAnySize) {
  for (const char* drawing : {".", "#", "?", ".#", "#.?", ".\n#"}) {
    for (const double resolution : {1e-4, 0.05, 50.0}) {
      const MapSummary s = summaryOf(drawing, resolution);
      EXPECT_NEAR(s.free_share + s.occupied_share + s.unknown_share, 1.0, 1e-12) << drawing;
      EXPECT_FALSE(describe(s).empty());
    }
  }
}

}  // namespace
}  // namespace racecar_mcl
