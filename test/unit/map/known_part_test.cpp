#include "map/known_part.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/localizer/localization_map.h"
#include "racecar_mcl/map/map_summary.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

/// A grid of free, occupied and unknown cells, the first and last of them known.
OccupancyGrid randomGrid(Random* random) {
  const GridGeometry geometry{20 + static_cast<int>(random->index(30)),
                              20 + static_cast<int>(random->index(20)),
                              0.1,
                              {1.0, -2.0, 0.4}};
  const CellIndex index(geometry);
  std::vector<std::int8_t> cells(index({0, geometry.height}), OccupancyGrid::kFree);
  for (std::int8_t& cell : cells) {
    const double draw = random->uniform();
    if (draw < 0.2) cell = draw < 0.1 ? OccupancyGrid::kOccupied : OccupancyGrid::kUnknown;
  }
  cells.front() = cells.back() = OccupancyGrid::kOccupied;
  return {geometry, std::move(cells)};
}

/// The grid in the middle of unknown cells.
OccupancyGrid surrounded(const OccupancyGrid& grid, int columns, int rows) {
  GridGeometry geometry = grid.geometry();
  geometry.width += 2 * columns;
  geometry.height += 2 * rows;
  geometry.origin =
      compose(geometry.origin, {-columns * geometry.resolution, -rows * geometry.resolution, 0.0});
  const CellIndex index(geometry);
  std::vector<std::int8_t> cells(index({0, geometry.height}), OccupancyGrid::kUnknown);
  for (int row = 0; row < grid.geometry().height; ++row) {
    for (int column = 0; column < grid.geometry().width; ++column) {
      cells[index({column + columns, row + rows})] = grid.at({column, row});
    }
  }
  return {geometry, std::move(cells)};
}

/// The expected range of a beam along the x axis of the lidar, m.
float castAhead(const RangeCaster& caster, const Pose2& lidar_in_map) {
  Eigen::ArrayXXf ranges(1, 1);
  caster.cast(batchOf(lidar_in_map), Eigen::ArrayXf::Zero(1), ranges);
  return ranges(0, 0);
}

TEST(KnownPart, HasTwoUnknownColumnsAndRowsOnEachSide) {
  const OccupancyGrid whole = asciiMap(R"(
      ?????????
      ?????????
      ?????????
      ???#.????
      ????#????
      ?????????)",
                                       0.5, {10.0, 20.0, kPi / 2});
  const KnownPart known(whole);
  const OccupancyGrid& part = known.grid();
  EXPECT_EQ(part.geometry().width, 6);
  EXPECT_EQ(part.geometry().height, 5) << "the map has only one row below";
  EXPECT_EQ(part.cells(), asciiMap(R"(
      ??????
      ??????
      ??#.??
      ???#??
      ??????)")
                              .cells());
  EXPECT_NEAR(part.geometry().origin.x, 10.0, 1e-12);
  EXPECT_NEAR(part.geometry().origin.y, 20.5, 1e-12);
  EXPECT_EQ(part.geometry().origin.yaw, whole.geometry().origin.yaw);
}

TEST(KnownPart, IsTheWholeWhereAllIsKnownOrNothing) {
  for (const char* drawing : {"#.#\n...\n#.#", "???\n???", "?????\n?#.#?\n?????"}) {
    const OccupancyGrid whole = asciiMap(drawing);
    EXPECT_EQ(&KnownPart(whole).grid(), &whole) << drawing;
  }
}

TEST(KnownPart, TheSummaryOfAMapDoesNotDependOnUnknownCellsAround) {
  Random random(1);
  for (int i = 0; i < 30; ++i) {
    const OccupancyGrid grid = randomGrid(&random);
    // Two cells, which are kept, leave the part as large as the whole; more are cut off.
    const MapSummary few = summarize(surrounded(grid, 2, 2));
    const MapSummary many = summarize(surrounded(grid, 3 + i, 40 - i));
    EXPECT_EQ(many.free_area, few.free_area);
    EXPECT_EQ(many.largest_free_area, few.largest_free_area);
    EXPECT_EQ(many.free_areas, few.free_areas);
    EXPECT_EQ(many.surface_cells, few.surface_cells);
    EXPECT_EQ(many.blurred_area, few.blurred_area);
    EXPECT_EQ(many.hidden_share, few.hidden_share);
    EXPECT_EQ(many.opening_share, few.opening_share);
    EXPECT_EQ(many.free_cells_at_border, 0u);
    EXPECT_GT(many.unknown_share, few.unknown_share);
    EXPECT_NEAR(many.free_share + many.occupied_share + many.unknown_share, 1.0, 1e-12);
  }
}

TEST(KnownPart, LikelihoodsAndRangesDoNotDependOnUnknownCellsAround) {
  Random random(2);
  for (const UnknownIs unknown_is : {UnknownIs::kFree, UnknownIs::kOccupied}) {
    for (int i = 0; i < 10; ++i) {
      const OccupancyGrid grid = randomGrid(&random);
      SensorParameters parameters;
      parameters.caster.unknown_is = unknown_is;
      const auto few = makeLocalizationMap(surrounded(grid, 2, 2), parameters);
      const auto many = makeLocalizationMap(surrounded(grid, 3 + i, 40 - i), parameters);
      EXPECT_EQ(many->likelihood_field->memoryBytes(), few->likelihood_field->memoryBytes());
      EXPECT_EQ(many->caster->memoryBytes(), few->caster->memoryBytes());
      EXPECT_EQ(many->matcher.poses(), few->matcher.poses());
      EXPECT_EQ(many->free_cells.size(), few->free_cells.size());

      Scan beams;
      beams.bearings = Eigen::ArrayXf::LinSpaced(40, -3.0f, 3.0f);
      beams.ranges = Eigen::ArrayXf::LinSpaced(40, 0.1f, 6.0f);
      for (int k = 0; k < 20; ++k) {
        const Pose2 pose{random.uniform(-3.0, 6.0), random.uniform(-3.0, 6.0),
                         random.uniform(-kPi, kPi)};
        const Eigen::ArrayXf expected = few->likelihood_field->beamLogLikelihoods(pose, beams);
        const Eigen::ArrayXf values = many->likelihood_field->beamLogLikelihoods(pose, beams);
        EXPECT_LT((values - expected).abs().maxCoeff(), 1e-4f);
        EXPECT_NEAR(castAhead(*many->caster, pose), castAhead(*few->caster, pose), 1e-3f);
      }
    }
  }
}

}  // namespace
}  // namespace racecar_mcl
