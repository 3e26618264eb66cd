#include "sim/map_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/cell_runs.h"
#include "racecar_mcl/map/map_io.h"
#include "sim/random_placement.h"
#include "sim/wall_surfaces.h"
#include "support/ascii_map.h"

namespace racecar_mcl::sim {
namespace {

OccupancyGrid corridor() { return loadMap(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml"); }
OccupancyGrid track() { return loadMap(RACECAR_MCL_SOURCE_DIR "/maps/track.yaml"); }

/// `size` x `size` cells of 5 cm with the values of `value`, else free.
OccupancyGrid hall(int size, const std::function<std::int8_t(int column, int row)>& value) {
  std::vector<std::int8_t> cells;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) cells.push_back(value(column, row));
  }
  return OccupancyGrid({size, size, 0.05, {}}, std::move(cells));
}

long countOf(const OccupancyGrid& map, std::int8_t value) {
  return std::count(map.cells().begin(), map.cells().end(), value);
}

/// The changed cells, grouped by their value in `after`.
long changedTo(const OccupancyGrid& before, const OccupancyGrid& after, std::int8_t value) {
  long count = 0;
  for (std::size_t i = 0; i < before.cells().size(); ++i) {
    count += before.cells()[i] != after.cells()[i] && after.cells()[i] == value ? 1 : 0;
  }
  return count;
}

TEST(MapFaults, TheUnknownIsFilledAndNothingElseChanges) {
  EXPECT_EQ(toAscii(fillUnknown(asciiMap("?#.?"))), "##.#\n");
}

TEST(MapFaults, GreyWallsLieAbout60AndFreeCellsBelow20) {
  Random random(1);
  const OccupancyGrid map = corridor();
  const OccupancyGrid grey = greyCells(map, random);
  double walls = 0.0, squares = 0.0;
  int brightest = 100, darkest = 0;
  for (std::size_t i = 0; i < map.cells().size(); ++i) {
    const int value = grey.cells()[i];
    if (map.cells()[i] == OccupancyGrid::kUnknown) {
      ASSERT_EQ(value, OccupancyGrid::kUnknown);
    } else if (map.cells()[i] == OccupancyGrid::kOccupied) {
      walls += value;
      squares += value * value;
    } else {
      brightest = std::min(brightest, value);
      darkest = std::max(darkest, value);
    }
  }
  const auto count = static_cast<double>(countOf(map, OccupancyGrid::kOccupied));
  EXPECT_NEAR(walls / count, 60.0, 0.5);
  EXPECT_NEAR(std::sqrt(squares / count - walls / count * walls / count), 5.0, 0.5);
  EXPECT_EQ(brightest, 0);
  EXPECT_EQ(darkest, 20);
}

class MapFaultsOn : public testing::TestWithParam<OccupancyGrid (*)()> {
 protected:
  const OccupancyGrid map_ = GetParam()();
};

TEST_P(MapFaultsOn, TheShareOfTheWallsIsErasedInStretchesToWhatLiesBehind) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Random random(seed);
    const OccupancyGrid erased = eraseWalls(map_, 0.3, random);
    const WallSurfaces walls(map_);
    std::size_t gone = 0;
    for (const std::size_t i : walls.surface()) gone += isOccupied(erased.cells()[i]) ? 0 : 1;
    // The last segment may exceed the fraction.
    const double stretch = 3.5 / 0.05;
    const auto all = static_cast<double>(walls.surface().size());
    EXPECT_GE(static_cast<double>(gone), 0.3 * all);
    EXPECT_LE(static_cast<double>(gone), 0.3 * all + 2.0 * stretch);
    // Only walls change; behind them these maps are unknown.
    for (std::size_t i = 0; i < map_.cells().size(); ++i) {
      ASSERT_TRUE(erased.cells()[i] == map_.cells()[i] || isOccupied(map_.cells()[i]));
    }
    EXPECT_GT(changedTo(map_, erased, OccupancyGrid::kUnknown),
              10 * changedTo(map_, erased, OccupancyGrid::kFree));
  }
}

TEST_P(MapFaultsOn, AWingOfAQuarterIsUnknownAndTheRestAsItWas) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Random random(seed);
    const OccupancyGrid erased = eraseWing(map_, 0.25, random);
    const auto before = static_cast<double>(freeCells(map_).size());
    EXPECT_NEAR(static_cast<double>(freeCells(erased).size()), 0.75 * before, 0.01 * before);
    for (std::size_t i = 0; i < map_.cells().size(); ++i) {
      ASSERT_TRUE(erased.cells()[i] < 0 || erased.cells()[i] == map_.cells()[i]);
    }
  }
}

TEST_P(MapFaultsOn, ADistortedMapIsOffByNoMoreThanACellHereAndThere) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Random random(seed);
    const OccupancyGrid bent = distort(map_, 0.05, 0.0087, random);
    const CellIndex index(map_.geometry());
    long moved = 0;
    const auto hasNeighbour = [&](const OccupancyGrid& map, std::size_t cell) {
      const auto round = neighbours(index.cell(cell));
      return std::any_of(round.begin(), round.end(),
                         [&](const Cell& next) { return isOccupied(map.at(next)); });
    };
    for (std::size_t i = 0; i < map_.cells().size(); ++i) {
      if (isOccupied(map_.cells()[i]) == isOccupied(bent.cells()[i])) continue;
      ++moved;
      ASSERT_TRUE(hasNeighbour(isOccupied(map_.cells()[i]) ? bent : map_, i));
    }
    EXPECT_GT(moved, countOf(map_, OccupancyGrid::kOccupied) / 10);
  }
}

TEST_P(MapFaultsOn, DoorsAreFewAndNarrow) {
  Random random(1);
  const OccupancyGrid changed = changeDoors(map_, random);
  const double doors =
      std::floor(static_cast<double>(WallSurfaces(map_).surface().size()) * 0.05 / 15.0);
  const long opened = changedTo(map_, changed, OccupancyGrid::kUnknown) +
                      changedTo(map_, changed, OccupancyGrid::kFree);
  EXPECT_GT(static_cast<double>(opened), doors / 2.0 * 0.9 / 0.05);
  // A gap is 18 cells long, with a corner or a post somewhat more, and a wall at most 7 thick.
  EXPECT_LT(static_cast<double>(opened), doors * 24 * 7);
}

INSTANTIATE_TEST_SUITE_P(Maps, MapFaultsOn, testing::Values(&corridor, &track));

TEST(MapFaults, AnErasedWallLeavesWhatIsOnItsOtherSide) {
  for (const std::int8_t behind : {OccupancyGrid::kFree, OccupancyGrid::kUnknown}) {
    // A wall across the hall, three cells thick.
    const OccupancyGrid map = hall(61, [&](int, int row) {
      return row < 29 ? OccupancyGrid::kFree : row > 31 ? behind : OccupancyGrid::kOccupied;
    });
    WallSurfaces walls(map);
    walls.erase(29 * 61 + 30, 1.0);
    const OccupancyGrid erased(map.geometry(), walls.cells());
    for (int row = 29; row <= 31; ++row) {
      for (int column = 0; column < 61; ++column) {
        const int off = std::abs(column - 30);
        if (off >= 9 && off <= 11) continue;
        EXPECT_EQ(erased.at({column, row}), off < 9 ? behind : OccupancyGrid::kOccupied)
            << column << ", " << row;
      }
    }
  }
}

TEST(MapFaults, AnErasedStretchOfASolidMapIsUnknownAMetreDeep) {
  const OccupancyGrid map = hall(
      81, [](int, int row) { return row < 20 ? OccupancyGrid::kFree : OccupancyGrid::kOccupied; });
  WallSurfaces walls(map);
  walls.erase(20 * 81 + 40, 1.0);
  const OccupancyGrid erased(map.geometry(), walls.cells());
  EXPECT_EQ(erased.at({40, 20}), OccupancyGrid::kUnknown);
  EXPECT_EQ(erased.at({40, 39}), OccupancyGrid::kUnknown);
  EXPECT_EQ(erased.at({40, 42}), OccupancyGrid::kOccupied);
  EXPECT_EQ(erased.at({55, 20}), OccupancyGrid::kOccupied);
}

TEST(MapFaults, OnlyThingsThatStandFreeAreObjects) {
  EXPECT_EQ(countObjects(asciiMap(R"(
      ##########
      #........#
      #.##...#.#
      #.##.....#
      #......#.#
      #....#..##
      ##########)",
                                  0.2)),
            2);  // one touches the wall at a corner; walls do not count
  EXPECT_EQ(countObjects(asciiMap("...\n.#.\n...", 0.05)), 0);     // too small
  EXPECT_EQ(countObjects(asciiMap("?...\n.#..\n....")), 0);        // next to an unknown cell
  EXPECT_EQ(countObjects(asciiMap("......\n.####.\n......")), 0);  // 4 m across
}

TEST(MapFaults, TheShareOfTheObjectsIsMovedToWhereThereIsRoom) {
  const OccupancyGrid map = hall(101, [](int column, int row) {
    return column % 25 < 3 && row % 25 < 4 && column > 20 && row > 20 && column < 99 && row < 99
               ? OccupancyGrid::kOccupied
               : OccupancyGrid::kFree;
  });
  ASSERT_EQ(countObjects(map), 9);
  for (const std::uint64_t seed : {1, 2, 3}) {
    Random random(seed);
    const OccupancyGrid changed = moveObjects(map, 0.3, random);
    EXPECT_EQ(countObjects(changed), 9);
    EXPECT_EQ(countOf(changed, OccupancyGrid::kOccupied), 9 * 12);
    EXPECT_EQ(changedTo(map, changed, OccupancyGrid::kFree), 3 * 12);
  }
}

TEST(MapFaults, AnOpeningIsClosedAndACornerIsNone) {
  // A niche of 1 m x 1 m in the upper wall of a hall.
  const OccupancyGrid map = hall(100, [](int column, int row) {
    const bool niche = column >= 40 && column < 60 && row >= 60 && row < 80;
    const bool inside = column >= 5 && column < 95 && row >= 5 && row < 60;
    return niche || inside ? OccupancyGrid::kFree : OccupancyGrid::kOccupied;
  });
  Random random(1);
  const OccupancyGrid changed = changeDoors(map, random);
  int columns = 0;
  for (int column = 40; column < 60; ++column) {
    for (int row = 55; row < 80; ++row) {
      if (!isOccupied(changed.at({column, row}))) continue;
      ++columns;
      break;
    }
  }
  EXPECT_EQ(columns, 20);
  EXPECT_LT(changedTo(map, changed, OccupancyGrid::kOccupied), 30);
}

TEST(MapFaults, BoxesStandInTheWorldWhereTheMapHasTooFewThings) {
  const Pose2 keep_clear{-1.2758, -7.9622, 0.3};
  const World track_world(loadMap(RACECAR_MCL_SOURCE_DIR "/maps/track_world.yaml"));
  Random random(1);
  ASSERT_EQ(countObjects(track()), 0);
  const WrongMap wrong =
      makeWrongMap(MapFault::kMovedObjects, track(), track_world, keep_clear, random);
  const auto boxes = static_cast<int>(wrong.boxes.size());
  EXPECT_EQ(boxes, static_cast<int>(track_world.freeArea() / 25.0));
  EXPECT_EQ(countObjects(wrong.map), boxes);
  int elsewhere = 0;
  for (const Obstacle& box : wrong.boxes) {
    EXPECT_GT(distance(box.in_map, keep_clear), 3.0);
    elsewhere += wrong.map.isFree(cellAt(wrong.map.geometry(), {box.in_map.x, box.in_map.y}));
  }
  EXPECT_EQ(elsewhere, std::ceil(0.3 * boxes));

  const World corridor_world(loadMap(RACECAR_MCL_SOURCE_DIR "/maps/corridor_world.yaml"));
  const int things = countObjects(corridor());
  EXPECT_GE(things, static_cast<int>(corridor_world.freeArea() / 25.0));
  EXPECT_TRUE(
      makeWrongMap(MapFault::kMovedObjects, corridor(), corridor_world, {}, random).boxes.empty());

  // Other obstacles also find room and keep their distance.
  for (const Obstacle& other :
       scatterObstacles(track_world, 10, 4, keep_clear, random, wrong.boxes)) {
    for (const Obstacle& box : wrong.boxes) {
      for (double time = 0.0; time < 10.0; time += 0.1) {
        ASSERT_GT(distance(poseAt(other, time), box.in_map), 1.15);
      }
    }
  }

  const World no_room(asciiMap("#.#"));
  EXPECT_TRUE(placeBoxes(no_room, 3, {}, random).empty());
}

TEST(MapFaults, AreTheSameForTheSameSeedAndChangeTheMap) {
  const World world(loadMap(RACECAR_MCL_SOURCE_DIR "/maps/corridor_world.yaml"));
  for (const auto& [name, fault] : mapFaults()) {
    const auto cells = [&](std::uint64_t seed) {
      Random random(seed);
      return makeWrongMap(fault, corridor(), world, {}, random).map.cells();
    };
    EXPECT_EQ(cells(1), cells(1)) << name;
    EXPECT_EQ(cells(1) == corridor().cells(), fault == MapFault::kNone) << name;
    const bool drawn = fault != MapFault::kNone && fault != MapFault::kFilled;
    EXPECT_EQ(cells(1) != cells(2), drawn) << name;
  }
}

TEST(MapFaults, AMapWithoutWallsOrFreeCellsIsLeftAlone) {
  Random random(1);
  for (const char* drawing : {"....", "????", "####"}) {
    const OccupancyGrid map = asciiMap(drawing);
    EXPECT_EQ(toAscii(eraseWalls(map, 0.3, random)), toAscii(map));
    EXPECT_EQ(toAscii(moveObjects(map, 0.3, random)), toAscii(map));
    EXPECT_EQ(toAscii(changeDoors(map, random)), toAscii(map));
  }
  EXPECT_EQ(toAscii(eraseWing(asciiMap("?##"), 0.25, random)), "?##\n");
}

TEST(MapFaults, DrawObstaclesWhereTheyStand) {
  Obstacle box;
  box.shape = Obstacle::Shape::kBox;
  box.length = 1.9;
  box.width = 1.0;
  box.in_map = {2.5, 2.0, kPi / 2.0};
  EXPECT_EQ(toAscii(withObstacles(asciiMap("....\n....\n....\n...."), {box}, 0.0)),
            "....\n..#.\n..#.\n....\n");
}

}  // namespace
}  // namespace racecar_mcl::sim
