#include "racecar_mcl/relocalization/global_scan_matcher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/raycasting/range_caster.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

/// Two rooms joined by a door, 12 x 8 m; unambiguous.
OccupancyGrid flat(const Pose2& origin = {}) {
  return asciiMap(R"(
      ########################
      #...........#..........#
      #...........#..........#
      #...........#.......####
      #......................#
      #......................#
      #...........#..........#
      #..##.......#..........#
      #..##.......######.....#
      #...........#..........#
      #...........#..........#
      #######.....#..........#
      #...........#......##..#
      #...........#......##..#
      #...........#..........#
      ########################)",
                  0.5, origin);
}

/// Symmetric under half a turn, 12 x 8 m.
OccupancyGrid bareRoom() {
  return asciiMap(R"(
      ############
      #..........#
      #..........#
      #..........#
      #..........#
      #..........#
      #..........#
      ############)");
}

Scan scanFrom(const OccupancyGrid& grid, const Pose2& base_in_map,
              const Pose2& laser_in_base = {0.2, 0.1, 0.3}) {
  Scan scan;
  scan.laser_in_base = laser_in_base;
  scan.bearings = Eigen::ArrayXf::LinSpaced(120, -2.3f, 2.3f);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(120);
  const Pose2 lidar = compose(base_in_map, laser_in_base);
  Eigen::ArrayXXf ranges(120, 1);
  makeRangeCaster(grid, {"bresenham", 30.0, UnknownIs::kFree})
      ->cast({&lidar.x, &lidar.y, &lidar.yaw, 1}, scan.bearings, ranges);
  scan.ranges = ranges.col(0);
  return scan;
}

double shareNear(const ParticleSet& particles, const Pose2& pose) {
  int near = 0;
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    near += distance(particles.pose(i), pose) < 0.5 &&
                    std::abs(wrapAngle(particles.yaw[i] - pose.yaw)) < 0.3
                ? 1
                : 0;
  }
  return static_cast<double>(near) / static_cast<double>(particles.size());
}

TEST(GlobalScanMatcher, FindsThePoseOfAScan) {
  const OccupancyGrid grid = flat();
  const GlobalScanMatcher search(grid, {});
  Random random(1);
  for (const Pose2& truth :
       {Pose2{2.2, 1.4, 0.4}, Pose2{9.7, 6.3, -2.8}, Pose2{6.6, 5.6, 3.1}, Pose2{8.1, 1.2, -1.5}}) {
    const ParticleSet candidates = search.candidates(scanFrom(grid, truth), 2000, random);
    ASSERT_EQ(candidates.size(), 2000);
    EXPECT_GT(shareNear(candidates, truth), 0.05) << truth.x << " " << truth.y << " " << truth.yaw;
    EXPECT_NEAR(candidates.log_weight.exp().sum(), 1.0, 1e-9);
  }
}

TEST(GlobalScanMatcher, HandlesARotatedMap) {
  const OccupancyGrid grid = flat({-3.0, 5.0, 2.0});
  const GlobalScanMatcher search(grid, {});
  Random random(2);
  const Pose2 truth = compose({-3.0, 5.0, 2.0}, {9.7, 6.3, -2.8});
  EXPECT_GT(shareNear(search.candidates(scanFrom(grid, truth), 2000, random), truth), 0.05);
}

TEST(GlobalScanMatcher, KeepsEveryMatchingPlace) {
  const OccupancyGrid grid = bareRoom();
  const GlobalScanMatcher search(grid, {});
  Random random(3);
  const Pose2 truth{3.0, 2.5, 0.7};
  const Pose2 twin{12.0 - truth.x, 8.0 - truth.y, truth.yaw - kPi};
  const ParticleSet candidates = search.candidates(scanFrom(grid, truth), 4000, random);
  EXPECT_GT(shareNear(candidates, truth), 0.05);
  EXPECT_GT(shareNear(candidates, twin), 0.05);
}

TEST(GlobalScanMatcher, SearchesOnlyFreeSpace) {
  const OccupancyGrid grid = flat();
  const GlobalScanMatcher search(grid, {});
  Random random(4);
  const ParticleSet candidates = search.candidates(scanFrom(grid, {2.2, 1.4, 0.4}), 1000, random);
  // A lattice cell is free if any map cell in it is.
  const double slack = search.spacing() * std::sqrt(2.0);
  for (Eigen::Index i = 0; i < candidates.size(); ++i) {
    const Pose2 pose = candidates.pose(i);
    bool free = false;
    for (const double dx : {-slack, 0.0, slack}) {
      for (const double dy : {-slack, 0.0, slack}) {
        free |= grid.isFree(cellAt(grid.geometry(), {pose.x + dx, pose.y + dy}));
      }
    }
    ASSERT_TRUE(free) << pose.x << " " << pose.y;
  }
}

TEST(GlobalScanMatcher, CoversTheWholeMapForAScanWithoutReturns) {
  const OccupancyGrid grid = bareRoom();
  const GlobalScanMatcher search(grid, {});
  Scan scan = scanFrom(grid, {3.0, 2.5, 0.7});
  scan.ranges.setConstant(std::numeric_limits<float>::infinity());
  Random random(5);
  const ParticleSet candidates = search.candidates(scan, 4000, random);
  EXPECT_NEAR(candidates.x.mean(), 6.0, 0.3);
  EXPECT_NEAR(candidates.y.mean(), 4.0, 0.3);
  EXPECT_NEAR((candidates.x - candidates.x.mean()).square().mean(), 100.0 / 12.0, 1.0);
  EXPECT_NEAR(candidates.yaw.cos().mean(), 0.0, 0.05);
}

TEST(GlobalScanMatcher, WidensItsLatticeOnAMapThatIsTooLarge) {
  const OccupancyGrid grid({400, 400, 0.5, {}}, std::vector<std::int8_t>(160000, 0));
  GlobalScanMatcherParameters parameters;
  parameters.search_poses = 1000000;
  const GlobalScanMatcher search(grid, parameters);
  EXPECT_LE(search.poses(), 1000000u);
  EXPECT_GT(search.poses(), 200000u);
  EXPECT_GT(search.spacing(), 0.5);
}

TEST(GlobalScanMatcher, NeedsNoMoreMemoryForBeamsThatReachFarBeyondTheMap) {
  const OccupancyGrid grid = flat();
  GlobalScanMatcherParameters parameters;
  parameters.search_max_range = 1000.0;
  const GlobalScanMatcher search(grid, parameters);
  EXPECT_LT(search.memoryBytes(), 100000u);
  Random random(8);
  const Pose2 truth{2.2, 1.4, 0.4};
  Scan scan = scanFrom(grid, truth);
  scan.ranges.head(10) = 900.0f;
  EXPECT_GT(shareNear(search.candidates(scan, 2000, random), truth), 0.05);
}

TEST(GlobalScanMatcher, OneSeedGivesOneResult) {
  const OccupancyGrid grid = flat();
  const GlobalScanMatcher search(grid, {});
  const Scan scan = scanFrom(grid, {2.2, 1.4, 0.4});
  const auto run = [&](std::uint64_t seed) {
    Random random(seed);
    return search.candidates(scan, 500, random);
  };
  EXPECT_TRUE((run(6).x == run(6).x).all());
  EXPECT_TRUE((run(6).yaw == run(6).yaw).all());
  EXPECT_FALSE((run(6).x == run(7).x).all());
}

TEST(GlobalScanMatcher, RejectsParametersOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, 1e4, nan}) {
    GlobalScanMatcherParameters p;
    p.search_spacing = bad;
    EXPECT_THROW(validate(p), ParameterError);
    p = {};
    p.search_yaw_spacing = bad;
    EXPECT_THROW(validate(p), ParameterError);
    p = {};
    p.search_max_range = bad;
    EXPECT_THROW(validate(p), ParameterError);
  }
  GlobalScanMatcherParameters p;
  p.search_beams = 0;
  EXPECT_THROW(validate(p), ParameterError);
  p = {};
  p.search_poses = 10;
  EXPECT_THROW(validate(p), ParameterError);
  EXPECT_NO_THROW(validate(GlobalScanMatcherParameters{}));
}

TEST(GlobalScanMatcher, HasTheLatticeOfItsParameters) {
  const std::size_t cells = freeCells(flat()).size();
  EXPECT_EQ(GlobalScanMatcher(flat(), {}).poses(), 105 * cells);  // 2 pi / 0.06 rad
  GlobalScanMatcherParameters wide;
  wide.search_yaw_spacing = 0.5;
  EXPECT_EQ(GlobalScanMatcher(flat(), wide).poses(), 13 * cells);
  wide.search_spacing = 1.0;
  const GlobalScanMatcher search(flat(), wide);
  EXPECT_EQ(search.spacing(), 1.0);
  EXPECT_LT(search.poses(), 13 * cells / 2);
}

TEST(GlobalScanMatcher, FindsLittleWithOneBeam) {
  const OccupancyGrid grid = flat();
  const Pose2 truth{2.2, 1.4, 0.4};
  const auto shareWith = [&](int beams) {
    GlobalScanMatcherParameters parameters;
    parameters.search_beams = beams;
    Random random(9);
    return shareNear(
        GlobalScanMatcher(grid, parameters).candidates(scanFrom(grid, truth), 2000, random), truth);
  };
  EXPECT_LT(shareWith(1), 0.5 * shareWith(60));
}

TEST(GlobalScanMatcher, NeedsTheMemoryOfItsRange) {
  const auto bytesWith = [](double max_range) {
    GlobalScanMatcherParameters parameters;
    parameters.search_max_range = max_range;
    return GlobalScanMatcher(flat(), parameters).memoryBytes();
  };
  EXPECT_LT(bytesWith(1.0), bytesWith(30.0));
}

TEST(GlobalScanMatcher, FindsThePoseOfACarWithTheLidarMountedSideways) {
  const OccupancyGrid grid = flat();
  const Pose2 truth{2.2, 1.4, 0.4};
  const Scan scan = scanFrom(grid, truth, {0.2, 0.1, 1.5});
  Random random(10);
  EXPECT_GT(shareNear(GlobalScanMatcher(grid, {}).candidates(scan, 2000, random), truth), 0.05);
}

TEST(GlobalScanMatcher, ComparesNoBeamsBeyondItsRange) {
  const OccupancyGrid grid = flat();
  GlobalScanMatcherParameters parameters;
  parameters.search_max_range = 4.0;
  const GlobalScanMatcher search(grid, parameters);
  Scan scan = scanFrom(grid, {2.2, 1.4, 0.4});
  const auto candidatesWith = [&](float range) {
    scan.ranges.head(40) = range;
    Random random(11);
    return search.candidates(scan, 500, random);
  };
  const float none = std::numeric_limits<float>::infinity();
  EXPECT_TRUE((candidatesWith(7.0f).x == candidatesWith(none).x).all());
  EXPECT_FALSE((candidatesWith(3.0f).x == candidatesWith(none).x).all());
}

}  // namespace
}  // namespace racecar_mcl
