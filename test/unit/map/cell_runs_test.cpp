#include "racecar_mcl/map/cell_runs.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

TEST(CellRuns, HoldCellsInTheirOrder) {
  const std::vector<Cell> cells = {{2, 0}, {3, 0}, {5, 0}, {0, 1}, {1, 1}, {2, 1}, {3, 3}};
  CellRuns runs;
  EXPECT_TRUE(runs.empty());
  EXPECT_EQ(runs.size(), 0U);
  for (const Cell& cell : cells) runs.add(cell);
  EXPECT_FALSE(runs.empty());
  EXPECT_EQ(runs.size(), cells.size());
  EXPECT_EQ(runs.cells(), cells);
  for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_EQ(runs[i], cells[i]) << i;
  EXPECT_EQ(runs.runs().size(), 4U);
}

TEST(CellRuns, EndWithTheRow) {
  CellRuns runs;
  runs.add({1, 0});
  runs.add({2, 1});
  EXPECT_EQ(runs.runs().size(), 2U);
}

}  // namespace
}  // namespace racecar_mcl
