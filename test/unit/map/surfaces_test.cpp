#include "racecar_mcl/map/surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "racecar_mcl/relocalization/global_scan_matcher.h"
#include "racecar_mcl/sensor/likelihood_field.h"
#include "support/analytic_room.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

constexpr double kResolution = 0.05;  // m
constexpr int kRows = 61;

/// A map with identical rows.
OccupancyGrid striped(const std::string& row) {
  std::string drawing;
  for (int i = 0; i < kRows; ++i) drawing += row + "\n";
  return asciiMap(drawing, kResolution);
}

/// The middle row of a mask: 'x' and '.'.
std::string middleRow(const OccupancyGrid& grid, const std::vector<std::uint8_t>& mask) {
  const auto width = static_cast<std::size_t>(grid.geometry().width);
  const std::size_t first = width * static_cast<std::size_t>(grid.geometry().height / 2);
  std::string row;
  for (std::size_t i = first; i < first + width; ++i) row += mask[i] != 0 ? 'x' : '.';
  return row;
}

std::string visibleIn(const std::string& row) {
  const OccupancyGrid grid = striped(row);
  return middleRow(grid, findSurfaces(grid).visible);
}

std::string blurredIn(const std::string& row) {
  const OccupancyGrid grid = striped(row);
  return middleRow(grid, findSurfaces(grid).blurred);
}

std::string cells(int count, char symbol) { return std::string(std::size_t(count), symbol); }

TEST(VisibleSurfaces, AreTheFacesOfAreasFilledToTheEdge) {
  EXPECT_EQ(visibleIn("....########"), "....x.......");
  EXPECT_EQ(visibleIn("####....####"), "...x....x...");
}

TEST(VisibleSurfaces, AreBothFacesOfAThickWall) {
  EXPECT_EQ(visibleIn("...##########..."), "...x........x...");
}

TEST(VisibleSurfaces, AreAWallOfOnePixel) { EXPECT_EQ(visibleIn("....#...."), "....x...."); }

TEST(VisibleSurfaces, AreTheFirstOccupiedCellBehindAGreyOne) {
  EXPECT_EQ(visibleIn("...?####?..."), "....x..x....");
}

TEST(VisibleSurfaces, AreNotCellsDeeperInTheUnknown) {
  EXPECT_EQ(visibleIn("...??####.."), "........x..");
}

TEST(VisibleSurfaces, StandBeforeTheUnknown) {
  EXPECT_EQ(visibleIn("....#????"), "....x....");
  EXPECT_EQ(visibleIn("....##???"), "....x....");
}

TEST(VisibleSurfaces, AreNotWallsWithinTheUnknown) {
  EXPECT_EQ(visibleIn("...#???##???"), "...x........");
}

TEST(VisibleSurfaces, AreAllWallsOfAMapInWhichNoneIsNextToFreeSpace) {
  EXPECT_EQ(visibleIn("...???##???"), "......xx...");
  EXPECT_EQ(visibleIn("########"), "xxxxxxxx");
}

TEST(VisibleSurfaces, OfASlantingWallAreOneCellThick) {
  const OccupancyGrid grid = asciiMap(R"(
      ####
      .###
      ..##
      ...#)",
                                      kResolution);
  const std::vector<std::uint8_t> expected{0, 0, 0, 1,   // the lowest row
                                           0, 0, 1, 0,   //
                                           0, 1, 0, 0,   //
                                           1, 0, 0, 0};  //
  EXPECT_EQ(findSurfaces(grid).visible, expected);
}

TEST(BlurredSurfaces, AreAWallOfThreeFifthsOfAMetre) {
  EXPECT_EQ(blurredIn("......" + cells(12, '#') + "......"), "......" + cells(12, 'x') + "......");
}

TEST(BlurredSurfaces, AreAsThickAWallBeforeTheUnknown) {
  EXPECT_EQ(blurredIn("......" + cells(12, '#') + "??????"), "......" + cells(12, 'x') + "......");
}

TEST(BlurredSurfaces, AreNoThinWalls) {
  for (const int thickness : {1, 2, 6, 8}) {
    const std::string row = "......" + cells(thickness, '#') + "......";
    EXPECT_EQ(blurredIn(row), cells(12 + thickness, '.')) << thickness;
  }
}

TEST(BlurredSurfaces, AreNoThinWallsAtTheEdgeOfTheImage) {
  for (const int thickness : {1, 4, 6, 8}) {
    EXPECT_EQ(blurredIn("......" + cells(thickness, '#')), cells(6 + thickness, '.')) << thickness;
  }
}

TEST(BlurredSurfaces, AreNoFilledAreasOfTwoMetres) {
  EXPECT_EQ(blurredIn("......" + cells(40, '#') + "......"), cells(52, '.'));
}

TEST(BlurredSurfaces, AreNoAreasFilledToTheEdge) {
  EXPECT_EQ(blurredIn("......" + cells(40, '#')), cells(46, '.'));
}

TEST(BlurredSurfaces, AreMeasuredInMetresNotInCells) {
  const std::string row = "......" + cells(12, '#') + "......";
  std::string drawing;
  for (int i = 0; i < kRows; ++i) drawing += row + "\n";
  const OccupancyGrid fine = asciiMap(drawing, 0.025);  // 0.3 m
  EXPECT_EQ(middleRow(fine, findSurfaces(fine).blurred), cells(24, '.'));
  const OccupancyGrid coarse = asciiMap(drawing, 0.15);  // 1.8 m
  EXPECT_EQ(middleRow(coarse, findSurfaces(coarse).blurred), cells(24, '.'));
}

std::string unmappedIn(const std::string& row) {
  const OccupancyGrid grid = striped(row);
  return middleRow(grid, findUnmapped(grid, findSurfaces(grid)));
}

TEST(UnmappedCells, AreTheFirstMetreBehindAnOpeningAndADecimetreBeforeIt) {
  // The opening is the last free cell.
  EXPECT_EQ(unmappedIn("#" + cells(24, '.') + cells(30, '?')),
            cells(22, '.') + cells(3 + 20, 'x') + cells(10, '.'));
}

TEST(UnmappedCells, AreAtAnOpeningOrBehindIt) {
  const OccupancyGrid grid = striped("#" + cells(24, '.') + cells(30, '?'));
  const std::vector<std::uint8_t> unmapped = findUnmapped(grid, findSurfaces(grid));
  const auto at = [&](int column) {
    return int{unmapped[CellIndex(grid.geometry())({column, kRows / 2})]};
  };
  for (const int column : {22, 24, 25, 27}) EXPECT_EQ(at(column), kAtOpening) << column;
  for (const int column : {28, 44}) EXPECT_EQ(at(column), kBehindOpening) << column;
}

TEST(UnmappedCells, AreNotBehindAWall) {
  EXPECT_EQ(unmappedIn("#" + cells(20, '.') + "#" + cells(20, '?')), cells(42, '.'));
}

TEST(UnmappedCells, AreNotBehindASmoothedWall) {
  EXPECT_EQ(unmappedIn("#" + cells(20, '.') + "?##" + cells(20, '?')), cells(44, '.'));
}

TEST(UnmappedCells, AreNoSpecks) {
  EXPECT_EQ(unmappedIn("#" + cells(20, '.') + "?" + cells(20, '.') + "#"), cells(43, '.'));
}

TEST(UnmappedCells, AreNotWhereACarHasNoRoom) {
  EXPECT_EQ(unmappedIn(cells(20, '?') + cells(8, '.') + cells(20, '?')), cells(48, '.'));
}

TEST(UnmappedCells, AreNearerToTheOpeningThanToASurface) {
  // The wall on the right ends in row 30; below it is a gap.
  std::string drawing;
  for (int i = 0; i < kRows; ++i) {
    drawing += cells(20, '.') + (i <= 30 ? '#' : '?') + cells(19, '?') + "\n";
  }
  const OccupancyGrid grid = asciiMap(drawing, kResolution);
  const std::vector<std::uint8_t> unmapped = findUnmapped(grid, findSurfaces(grid));
  const auto at = [&](const Cell& cell) { return int{unmapped[CellIndex(grid.geometry())(cell)]}; };
  EXPECT_EQ(at({20, 20}), kAtOpening) << "in the gap";
  EXPECT_EQ(at({39, 10}), kBehindOpening) << "behind it";
  EXPECT_EQ(at({21, 35}), 0) << "behind the wall";
  EXPECT_EQ(at({30, 33}), 0) << "nearer to the end of the wall";
  EXPECT_EQ(at({30, 20}), kBehindOpening) << "nearer to the gap";
}

/// The same room with different cells behind its walls of one cell.
class RoomWithWallThickness : public ::testing::TestWithParam<int> {
 protected:
  /// Behind `black` more occupied cells, everything is unknown.
  OccupancyGrid drawn(int black) const {
    constexpr int kAround = 60;
    const OccupancyGrid thin = room_.grid();
    GridGeometry geometry = thin.geometry();
    geometry.origin.x -= kAround * geometry.resolution;
    geometry.origin.y -= kAround * geometry.resolution;
    geometry.width += 2 * kAround;
    geometry.height += 2 * kAround;
    std::vector<std::int8_t> cells;
    for (int row = 0; row < geometry.height; ++row) {
      for (int column = 0; column < geometry.width; ++column) {
        const Cell inner{column - kAround, row - kAround};
        const int beyond =
            std::max(std::max(-inner.column, inner.column - thin.geometry().width + 1),
                     std::max(-inner.row, inner.row - thin.geometry().height + 1));
        cells.push_back(beyond <= 0       ? thin.at(inner)
                        : beyond <= black ? OccupancyGrid::kOccupied
                                          : OccupancyGrid::kUnknown);
      }
    }
    return OccupancyGrid(geometry, std::move(cells));
  }

  const Room room_;
  const OccupancyGrid thin_ = drawn(0);
  const OccupancyGrid other_ = drawn(GetParam());
  const Pose2 truth_{2.5, 3.5, 0.7};
  const Scan scan_ = takeScan(room_, Sweep{}, 0.0, [this](double) { return truth_; });
};

TEST_P(RoomWithWallThickness, HasTheSameLikelihoodField) {
  const LikelihoodField thin(thin_, {}), other(other_, {});
  for (const Pose2& off : {Pose2{}, Pose2{0.1, 0.0, 0.0}, Pose2{-0.4, 0.3, 0.2},
                           Pose2{1.5, 0.0, 0.0}, Pose2{0.0, 0.0, 1.0}}) {
    const Pose2 lidar = compose(truth_, off);
    EXPECT_TRUE(
        (thin.beamLogLikelihoods(lidar, scan_) == other.beamLogLikelihoods(lidar, scan_)).all())
        << off.x;
  }
}

TEST_P(RoomWithWallThickness, HasTheSameGlobalSearch) {
  const GlobalScanMatcher thin(thin_, {}), other(other_, {});
  Random random(1), same_random(1);
  const ParticleSet a = thin.candidates(scan_, 500, random);
  const ParticleSet b = other.candidates(scan_, 500, same_random);
  EXPECT_TRUE((a.x == b.x && a.y == b.y && a.yaw == b.yaw).all());
  // The room is symmetric under half a turn.
  const Pose2 turned{room_.width - truth_.x, room_.height - truth_.y, wrapAngle(truth_.yaw + kPi)};
  int near = 0;
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    near += std::min(distance(b.pose(i), truth_), distance(b.pose(i), turned)) < 0.5 ? 1 : 0;
  }
  EXPECT_GT(near, 250);
}

INSTANTIATE_TEST_SUITE_P(CellsOfBlack, RoomWithWallThickness,
                         ::testing::Values(1, 5, 40, 60));  // 60: to the edge of the image

}  // namespace
}  // namespace racecar_mcl
