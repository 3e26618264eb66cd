#include "map_changes/map_changes.h"

#include <gtest/gtest.h>

#include "map_changes/map_change_report.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

/// A room of 18 x 9 free cells of 0.1 m, with a block of 2 x 2 cells in the columns 9 and 10 and
/// the rows 5 and 6, and unknown cells from column 19 on.
OccupancyGrid room() {
  return asciiMap(R"(
      ######################
      #..................???
      #..................???
      #..................???
      #........##........???
      #........##........???
      #..................???
      #..................???
      #..................???
      #..................???
      ######################)",
                  0.1);
}

/// The centres of the cells of a column, from row 2 to row 8.
std::vector<Eigen::Vector2d> acrossRoom(int column) {
  std::vector<Eigen::Vector2d> points;
  for (int row = 2; row <= 8; ++row) points.emplace_back(0.1 * column + 0.05, 0.1 * row + 0.05);
  return points;
}

/// The evidence of views of a lidar at the left of the room.
class RoomViews {
 public:
  /// `count` views with these ends, over `seconds` from the last view on.
  void add(const std::vector<Eigen::Vector2d>& ends, int count, double seconds) {
    View view;
    view.lidar_in_map = {0.25, 0.55};
    view.ends_in_map.resize(2, static_cast<Eigen::Index>(ends.size()));
    for (std::size_t k = 0; k < ends.size(); ++k) {
      view.ends_in_map.col(static_cast<Eigen::Index>(k)) = ends[k];
    }
    view.tolerances.setZero(static_cast<Eigen::Index>(ends.size()));
    for (int i = 0; i < count; ++i) {
      view.stamp = stamp_ + i * seconds / (count - 1);
      evidence_.add(view);
    }
    stamp_ += seconds;
  }

  MapChanges changes() const { return findChanges(room(), evidence_); }

 private:
  CellEvidence evidence_{room()};
  double stamp_ = 1000.0;
};

CellChange at(const MapChanges& changes, int column, int row) {
  return changes.cells[static_cast<std::size_t>(row * 22 + column)];
}

TEST(MapChanges, FindsWhatIsNew) {
  RoomViews views;
  views.add(acrossRoom(6), 8, 2.0);
  const MapChanges changes = views.changes();
  ASSERT_EQ(changes.regions.size(), 1u);
  const ChangedRegion& region = changes.regions[0];
  EXPECT_EQ(region.kind, CellChange::kNew);
  EXPECT_EQ(region.cells, 7);
  EXPECT_EQ(region.views, 8u);
  EXPECT_NEAR(region.centre_in_map.x(), 0.65, 1e-9);
  EXPECT_NEAR(region.centre_in_map.y(), 0.55, 1e-9);
  EXPECT_NEAR(region.size.x(), 0.1, 1e-9);
  EXPECT_NEAR(region.size.y(), 0.7, 1e-9);
  EXPECT_EQ(at(changes, 4, 5), CellChange::kConfirmed) << "passed";
  EXPECT_EQ(at(changes, 9, 5), CellChange::kNotSeen) << "behind it";
  EXPECT_EQ(
      changesCsv(changes),
      "number,kind,x,y,size_columns,size_rows,cells,views\n1,new,0.650,0.550,0.100,0.700,7,8\n");
  const OccupancyGrid proposed = applyChanges(room(), changes);
  EXPECT_EQ(proposed.at({6, 5}), OccupancyGrid::kOccupied);
  EXPECT_EQ(proposed.at({7, 5}), OccupancyGrid::kFree);
  EXPECT_EQ(proposed.at({9, 5}), OccupancyGrid::kOccupied);
  EXPECT_EQ(proposed.at({20, 5}), OccupancyGrid::kUnknown);
}

TEST(MapChanges, NeedsSeveralViewsOverSomeTime) {
  RoomViews brief;
  brief.add(acrossRoom(6), 20, 0.5);
  EXPECT_TRUE(brief.changes().regions.empty());
  RoomViews few;
  few.add(acrossRoom(6), 6, 5.0);
  EXPECT_TRUE(few.changes().regions.empty());
}

TEST(MapChanges, AreNotWhatHasMovedAway) {
  RoomViews views;
  views.add(acrossRoom(6), 20, 4.0);
  EXPECT_EQ(views.changes().regions.size(), 1u);
  views.add(acrossRoom(8), 2, 0.2);
  EXPECT_TRUE(views.changes().regions.empty());
  EXPECT_EQ(at(views.changes(), 6, 5), CellChange::kUnclear);
}

TEST(MapChanges, FindsWhatIsGone) {
  RoomViews views;
  views.add(acrossRoom(16), 10, 0.5);  // too short for new surfaces
  const MapChanges changes = views.changes();
  ASSERT_EQ(changes.regions.size(), 1u);
  EXPECT_EQ(changes.regions[0].kind, CellChange::kGone);
  EXPECT_EQ(changes.regions[0].cells, 4);
  EXPECT_NEAR(changes.regions[0].centre_in_map.x(), 1.0, 1e-9);
  EXPECT_NEAR(changes.regions[0].centre_in_map.y(), 0.6, 1e-9);
  EXPECT_EQ(applyChanges(room(), changes).at({9, 5}), OccupancyGrid::kFree);
}

TEST(MapChanges, AnEndWithinACellOfASurfaceConfirmsIt) {
  RoomViews views;
  views.add({{0.85, 0.55}, {0.85, 0.65}, {1.15, 0.45}}, 6, 3.0);
  const MapChanges changes = views.changes();
  EXPECT_TRUE(changes.regions.empty());
  EXPECT_EQ(at(changes, 9, 5), CellChange::kConfirmed);
}

TEST(MapChanges, ABeamThatEndsInAWallAtAGrazingAngleDoesNotPassThroughIt) {
  RoomViews views;
  views.add({{1.75, 0.02}}, 6, 3.0);
  const MapChanges changes = views.changes();
  EXPECT_EQ(changes.count(CellChange::kGone), 0u);
  EXPECT_EQ(at(changes, 17, 0), CellChange::kConfirmed);
}

TEST(MapChanges, FreesAndFillsUnknownCells) {
  RoomViews views;
  views.add(acrossRoom(21), 8, 3.0);
  const MapChanges changes = views.changes();
  EXPECT_EQ(at(changes, 19, 3), CellChange::kExplored);
  EXPECT_EQ(at(changes, 21, 2), CellChange::kNew);
  const OccupancyGrid proposed = applyChanges(room(), changes);
  EXPECT_EQ(proposed.at({19, 3}), OccupancyGrid::kFree);
  EXPECT_EQ(proposed.at({21, 2}), OccupancyGrid::kOccupied);
  EXPECT_EQ(proposed.at({19, 9}), OccupancyGrid::kUnknown);
}

}  // namespace
}  // namespace racecar_mcl
