#include "racecar_mcl/map/occupancy_grid.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/cell_runs.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// 8 x 3 cells of 0.5 m, rotated by a quarter turn to the left: columns run along the map's y, rows
// along its -x.
GridGeometry quarterTurned() { return {8, 3, 0.5, {10.0, -4.0, kPi / 2}}; }

void expectNear(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  EXPECT_NEAR(a.x(), b.x(), 1e-12);
  EXPECT_NEAR(a.y(), b.y(), 1e-12);
}

TEST(GridGeometry, PutsTheCornerOfTheFirstCellAtTheOrigin) {
  expectNear(gridToWorld(quarterTurned(), {0.0, 0.0}), {10.0, -4.0});
  expectNear(cellCentre({8, 3, 0.5, {}}, {0, 0}), {0.25, 0.25});
}

TEST(GridGeometry, RotatesTheGridAboutItsCorner) {
  expectNear(gridToWorld(quarterTurned(), {8.0, 0.0}), {10.0, 0.0});
  expectNear(gridToWorld(quarterTurned(), {0.0, 3.0}), {8.5, -4.0});
  expectNear(cellCentre(quarterTurned(), {7, 2}), {8.75, -0.25});
}

TEST(GridGeometry, WorldToGridInvertsGridToWorld) {
  const GridGeometry geometry{123, 7, 0.05, {-3.2, 8.1, 3.14}};
  const std::vector<Eigen::Vector2d> points = {{0.0, 0.0}, {122.5, 6.25}, {-40.0, 300.0}};
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d there_and_back = worldToGrid(geometry, gridToWorld(geometry, point));
    EXPECT_NEAR(there_and_back.x(), point.x(), 1e-9);
    EXPECT_NEAR(there_and_back.y(), point.y(), 1e-9);
  }
}

TEST(GridGeometry, EveryCellContainsItsCentre) {
  for (const double yaw : {0.0, 0.3, kPi / 2, 3.14, -2.0}) {
    const GridGeometry geometry{9, 4, 0.1, {-1.0, 2.0, yaw}};
    for (int row = 0; row < geometry.height; ++row) {
      for (int column = 0; column < geometry.width; ++column) {
        EXPECT_EQ(cellAt(geometry, cellCentre(geometry, {column, row})), (Cell{column, row}));
      }
    }
  }
}

TEST(GridGeometry, ACellOwnsItsLowerAndLeftEdge) {
  const GridGeometry geometry{4, 2, 1.0, {}};
  EXPECT_EQ(cellAt(geometry, {1.0, 1.0}), (Cell{1, 1}));
  EXPECT_EQ(cellAt(geometry, {0.999, 0.999}), (Cell{0, 0}));
  EXPECT_TRUE(contains(geometry, cellAt(geometry, {0.0, 0.0})));
  EXPECT_FALSE(contains(geometry, cellAt(geometry, {4.0, 1.0})));
  EXPECT_FALSE(contains(geometry, cellAt(geometry, {1.0, 2.0})));
  EXPECT_FALSE(contains(geometry, cellAt(geometry, {-1e-9, 1.0})));
}

TEST(GridGeometry, PointsFarAwayOrNotFiniteLieOutside) {
  const GridGeometry geometry{4, 2, 0.05, {1.0, 1.0, 0.7}};
  for (const double far : {1e12, -1e12, 1e300, kInfinity, -kInfinity, kNaN}) {
    EXPECT_FALSE(contains(geometry, cellAt(geometry, {far, 0.0}))) << far;
    EXPECT_FALSE(contains(geometry, cellAt(geometry, {0.0, far}))) << far;
  }
}

TEST(OccupancyGrid, HoldsTheLowestRowFirst) {
  const OccupancyGrid grid = asciiMap(R"(
      #..?
      ..##)");
  EXPECT_EQ(grid.geometry().width, 4);
  EXPECT_EQ(grid.geometry().height, 2);
  EXPECT_EQ(grid.at({2, 0}), OccupancyGrid::kOccupied);
  EXPECT_EQ(grid.at({0, 1}), OccupancyGrid::kOccupied);
  EXPECT_EQ(grid.at({3, 1}), OccupancyGrid::kUnknown);
  EXPECT_TRUE(grid.isFree({0, 0}));
  EXPECT_EQ(toAscii(grid), "#..?\n..##\n");
}

TEST(OccupancyGrid, IsUnknownOutside) {
  const OccupancyGrid grid = asciiMap("..");
  EXPECT_EQ(grid.at({-1, 0}), OccupancyGrid::kUnknown);
  EXPECT_EQ(grid.at({2, 0}), OccupancyGrid::kUnknown);
  EXPECT_EQ(grid.at({0, 1}), OccupancyGrid::kUnknown);
  EXPECT_FALSE(grid.isFree({0, -1}));
}

TEST(OccupancyGrid, ListsItsFreeCellsRowByRow) {
  const OccupancyGrid grid = asciiMap(R"(
      #.#
      .?.)");
  EXPECT_EQ(freeCells(grid).cells(), (std::vector<Cell>{{0, 0}, {2, 0}, {1, 1}}));
}

TEST(OccupancyGrid, MayHaveNoFreeCell) {
  EXPECT_TRUE(freeCells(asciiMap("#?")).empty());
  EXPECT_FALSE(hasFreeCell(asciiMap("#?")));
  EXPECT_TRUE(hasFreeCell(asciiMap("#.")));
  EXPECT_TRUE(freeCells(asciiMap("??")).empty());
}

TEST(OccupancyGrid, MasksUnknownCellsAsFreeOrOccupied) {
  const OccupancyGrid grid({5, 1, 1.0, {}}, {-1, 0, 49, 50, 100});
  EXPECT_EQ(obstacleMask(grid, UnknownIs::kFree), (std::vector<std::uint8_t>{0, 0, 0, 1, 1}));
  EXPECT_EQ(obstacleMask(grid, UnknownIs::kOccupied), (std::vector<std::uint8_t>{1, 0, 0, 1, 1}));
}

TEST(OccupancyGrid, RejectsInvalidGeometryAndCells) {
  const std::vector<std::int8_t> cells(6, 0);
  EXPECT_NO_THROW(OccupancyGrid({3, 2, 0.05, {}}, cells));
  EXPECT_THROW(OccupancyGrid({0, 2, 0.05, {}}, {}), MapError);
  EXPECT_THROW(OccupancyGrid({3, -2, 0.05, {}}, cells), MapError);
  EXPECT_THROW(OccupancyGrid({3, 3, 0.05, {}}, cells), MapError);
  EXPECT_THROW(OccupancyGrid({2147483647, 2147483647, 0.05, {}}, cells), MapError);
  for (const double resolution : {0.0, -0.05, kInfinity, kNaN, 1e308, 1001.0, 1e-5}) {
    EXPECT_THROW(OccupancyGrid({3, 2, resolution, {}}, cells), MapError) << resolution;
  }
  EXPECT_THROW(OccupancyGrid({3, 2, 0.05, {kNaN, 0, 0}}, cells), MapError);
  EXPECT_THROW(OccupancyGrid({3, 2, 0.05, {0, 0, kInfinity}}, cells), MapError);
  for (const Pose2& far :
       {Pose2{1e308, 0.0, 0.0}, Pose2{0.0, -1.1e7, 0.0}, Pose2{0.0, 0.0, 90.0}}) {
    EXPECT_THROW(OccupancyGrid({3, 2, 0.05, far}, cells), MapError);
  }
  EXPECT_NO_THROW(OccupancyGrid({3, 2, 0.05, {7e5, 5.4e6, 3.0}}, cells)) << "UTM";
  EXPECT_THROW(OccupancyGrid({2, 1, 0.05, {}}, {0, 101}), MapError);
  EXPECT_THROW(OccupancyGrid({2, 1, 0.05, {}}, {-2, 0}), MapError);
}

}  // namespace
}  // namespace racecar_mcl
