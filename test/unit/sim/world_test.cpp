#include "sim/world.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/map_io.h"
#include "support/ascii_map.h"
#include "support/temporary_directory.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A room of `width` x `height` cells, free inside a wall one cell thick.
OccupancyGrid room(int width, int height, double resolution, const Pose2& origin = {}) {
  std::vector<std::int8_t> cells;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const bool wall = row == 0 || column == 0 || row == height - 1 || column == width - 1;
      cells.push_back(wall ? OccupancyGrid::kOccupied : OccupancyGrid::kFree);
    }
  }
  return OccupancyGrid({width, height, resolution, origin}, std::move(cells));
}

/// Distance from (x, y) to the sides of the rectangle [x0, x1] x [y0, y1] around it.
double distanceToSides(double x, double y, double yaw, double x0, double y0, double x1, double y1) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  const double along_x = c > 0 ? (x1 - x) / c : c < 0 ? (x0 - x) / c : kInfinity;
  const double along_y = s > 0 ? (y1 - y) / s : s < 0 ? (y0 - y) / s : kInfinity;
  return std::min(along_x, along_y);
}

TEST(World, RangesInARoomAreExact) {
  const World world(room(502, 302, 0.01));  // free from (0.01, 0.01) to (5.01, 3.01)
  Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const double x = random.uniform(0.02, 5.0);
    const double y = random.uniform(0.02, 3.0);
    const double yaw = random.uniform(-kPi, kPi);
    EXPECT_NEAR(world.castWalls({x, y}, yaw, 100.0),
                distanceToSides(x, y, yaw, 0.01, 0.01, 5.01, 3.01), 1e-9);
  }
}

TEST(World, RangesAlongTheAxesAreExact) {
  const World world(room(502, 302, 0.01));
  EXPECT_NEAR(world.castWalls({1.0, 1.0}, 0.0, 100.0), 4.01, 1e-12);
  EXPECT_NEAR(world.castWalls({1.0, 1.0}, kPi / 2, 100.0), 2.01, 1e-12);
  EXPECT_NEAR(world.castWalls({1.0, 1.0}, kPi, 100.0), 0.99, 1e-12);
  EXPECT_NEAR(world.castWalls({1.0, 1.0}, -kPi / 2, 100.0), 0.99, 1e-12);
}

TEST(World, AYawOfTheOriginTurnsTheRoom) {
  const Pose2 origin{-2.0, 3.5, 2.1};
  const World world(room(502, 302, 0.01, origin));
  Random random(8);
  for (int i = 0; i < 500; ++i) {
    const Pose2 in_grid{random.uniform(0.02, 5.0), random.uniform(0.02, 3.0),
                        random.uniform(-kPi, kPi)};
    const Pose2 in_map = compose(origin, in_grid);
    EXPECT_NEAR(world.castWalls({in_map.x, in_map.y}, in_map.yaw, 100.0),
                distanceToSides(in_grid.x, in_grid.y, in_grid.yaw, 0.01, 0.01, 5.01, 3.01), 1e-9);
  }
}

TEST(World, RaysEndWithinTheMaximumOrNowhere) {
  const World world(room(502, 302, 0.01));
  EXPECT_NEAR(world.castWalls({1.0, 1.0}, 0.0, 4.02), 4.01, 1e-12);
  EXPECT_EQ(world.castWalls({1.0, 1.0}, 0.0, 4.0), kInfinity);
}

TEST(World, RaysFromOutsideEnterTheGrid) {
  const World world(asciiMap(R"(
      ....
      ..#.
      ....)"));
  EXPECT_NEAR(world.castWalls({-3.0, 1.5}, 0.0, 100.0), 5.0, 1e-12);
  EXPECT_NEAR(world.castWalls({2.5, 7.0}, -kPi / 2, 100.0), 5.0, 1e-12);
  EXPECT_EQ(world.castWalls({-3.0, 1.5}, kPi, 100.0), kInfinity);
  EXPECT_EQ(world.castWalls({-3.0, 0.5}, 0.0, 100.0), kInfinity);
}

TEST(World, InsideAWallTheRangeIsZeroAndUnknownIsOpen) {
  const World world(asciiMap("#?.#"));
  EXPECT_EQ(world.castWalls({0.5, 0.5}, 1.0, 10.0), 0.0);
  EXPECT_NEAR(world.castWalls({1.5, 0.5}, 0.0, 10.0), 1.5, 1e-12);
  EXPECT_TRUE(world.isWall({0.5, 0.5}));
  EXPECT_FALSE(world.isWall({1.5, 0.5}));
  EXPECT_FALSE(world.isWall({9.0, 9.0}));
  EXPECT_TRUE(world.isFree({2.5, 0.5}));
  for (const double x : {0.5, 1.5, 3.5, 9.0, -1.0}) EXPECT_FALSE(world.isFree({x, 0.5})) << x;
}

TEST(World, AWayEndsWhereItIsNotKnownToBeFree) {
  const World world(asciiMap("#?..?..", 1.0, {2.0, 3.0, kPi / 2}));  // columns run along y
  const auto way = [&](double along, double yaw, double max_range = 100.0) {
    return world.castWalls({1.5, 3.0 + along}, yaw, max_range, Ends::kWhereNotFree);
  };
  EXPECT_NEAR(way(2.5, kPi / 2), 1.5, 1e-12);
  EXPECT_NEAR(way(2.5, -kPi / 2), 0.5, 1e-12);
  EXPECT_NEAR(way(5.5, kPi / 2), 1.5, 1e-12);  // the grid's edge
  EXPECT_EQ(way(5.5, kPi / 2, 1.4), kInfinity);
  EXPECT_NEAR(way(5.5, 0.0), 0.5, 1e-12);
  for (const double along : {-0.5, 0.5, 1.5, 4.5, 7.5}) EXPECT_EQ(way(along, 1.0), 0.0) << along;
  EXPECT_EQ(world.castWalls({1.5, 5.5}, kPi / 2, 100.0), kInfinity);
}

TEST(World, AnythingThatIsNoNumberHitsNothing) {
  const World world(asciiMap("#.#"));
  EXPECT_EQ(world.castWalls({std::nan(""), 0.5}, 0.0, 10.0), kInfinity);
  EXPECT_EQ(world.castWalls({1.5, 0.5}, std::nan(""), 10.0), kInfinity);
}

TEST(World, ObstaclesHideTheWallsBehindThem) {
  const World world(room(502, 302, 0.01));
  Obstacle disc;
  disc.radius = 0.5;
  disc.in_map = {3.0, 1.0, 0.0};
  Obstacle box;
  box.shape = Obstacle::Shape::kBox;
  box.length = 0.4;
  box.width = 2.0;
  box.in_map = {1.0, 2.5, kPi / 2};  // its long side runs along x
  const std::vector<Obstacle> obstacles{disc, box};
  EXPECT_NEAR(world.cast({1.0, 1.0}, 0.0, 10.0, obstacles, 0.0).range, 1.5, 1e-12);
  EXPECT_FALSE(world.cast({1.0, 1.0}, 0.0, 10.0, obstacles, 0.0).on_wall);
  EXPECT_NEAR(world.cast({0.5, 1.0}, kPi / 2, 10.0, obstacles, 0.0).range, 1.3, 1e-12);
  EXPECT_NEAR(world.cast({1.0, 1.0}, kPi, 10.0, obstacles, 0.0).range, 0.99, 1e-12);
  EXPECT_TRUE(world.cast({1.0, 1.0}, kPi, 10.0, obstacles, 0.0).on_wall);
  EXPECT_EQ(world.cast({1.0, 1.0}, 0.0, 1.4, obstacles, 0.0).range, kInfinity);
}

TEST(Obstacle, WalksItsPathToAndFro) {
  Obstacle walker;
  walker.path = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}};
  walker.speed = 0.5;  // 6 s for the way out
  EXPECT_NEAR(poseAt(walker, 2.0).x, 1.0, 1e-12);
  EXPECT_NEAR(poseAt(walker, 5.0).y, 0.5, 1e-12);
  EXPECT_NEAR(poseAt(walker, 5.0).yaw, kPi / 2, 1e-12);
  EXPECT_NEAR(poseAt(walker, 7.0).y, 0.5, 1e-12);
  EXPECT_NEAR(poseAt(walker, 7.0).yaw, -kPi / 2, 1e-12);
  EXPECT_NEAR(poseAt(walker, 14.0).x, 1.0, 1e-12);
  walker.path = {{3.0, 4.0}};
  EXPECT_NEAR(poseAt(walker, 5.0).y, 4.0, 1e-12);
}

TEST(Obstacle, RefusesImpossibleSizes) {
  Obstacle obstacle;
  obstacle.radius = 0.0;
  EXPECT_THROW(obstacle.validate(), ParameterError);
  obstacle.radius = 0.1;
  obstacle.path = {{0.0, std::nan("")}};
  EXPECT_THROW(obstacle.validate(), ParameterError);
}

TEST(Glass, TakesItsShareOfTheWallsAndStaysWhereItIs) {
  const Glass glass{0.3, 0.6, 5};
  Random random(1);
  int glassy = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector2d point(random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0));
    glassy += World::isGlass(glass, point) ? 1 : 0;
    ASSERT_EQ(World::isGlass(glass, point), World::isGlass(glass, point));
  }
  EXPECT_NEAR(glassy / 5000.0, 0.3, 0.03);
  EXPECT_FALSE(World::isGlass({0.0, 0.6, 5}, {1.0, 1.0}));
}

TEST(StartPose, IsReadFromBesideTheMap) {
  const TemporaryDirectory folder;
  const std::string map = (folder.path() / "there.yaml").string();
  Pose2 start{9.0, 9.0, 9.0};
  EXPECT_FALSE(loadStartPose(map, start));
  EXPECT_EQ(start.x, 9.0);
  folder.write("there_start.yaml", "start: [1, -2.5, 0.5]\n");
  EXPECT_TRUE(loadStartPose(map, start));
  EXPECT_EQ(start.y, -2.5);
  folder.write("there_start.yaml", "start: [1, 2]\n");
  EXPECT_THROW(loadStartPose(map, start), MapError);
  folder.write("there_start.yaml", "begin: {}\n");
  EXPECT_THROW(loadStartPose(map, start), MapError);
}

TEST(WorldPath, IsTheFinerWorldWhereThereIsOne) {
  const TemporaryDirectory folder;
  const std::string map = (folder.path() / "there.yaml").string();
  EXPECT_EQ(worldPathFor(map), map);
  folder.write("there_world.yaml", "\n");
  EXPECT_EQ(worldPathFor(map), (folder.path() / "there_world.yaml").string());
}

}  // namespace
}  // namespace racecar_mcl::sim
