// What every range caster promises, whatever its name.
#include "racecar_mcl/range_caster.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "caster_reference.h"
#include "racecar_mcl/errors.h"
#include "racecar_mcl/random.h"

namespace racecar_mcl {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// How exact a caster says it is, in cells.
struct Promise {
  double flat_wall;            ///< where rays meet flat walls
  double p95;                  ///< 95 % of the rays of a random map
  double p999;                 ///< 99.9 % of them
  double over_three = 0.0005;  ///< share of rays off by more than three cells
};

Promise promiseOf(const std::string& name) {
  if (name == "bresenham" || name == "distance_transform") return {1e-4, 1e-3, 1e-3};
  throw std::invalid_argument("state what " + name + " promises");
}

const std::vector<std::string> kRoom = {
    "####################",  //
    "#..................#",  //
    "#..................#",  //
    "#..................#",  //
    "#..................#",  //
    "#..................#",  //
    "#..................#",  //
    "####################",
};

/// Poses one by one, for tests of a few rays.
struct Poses {
  explicit Poses(const std::vector<Pose2>& list) {
    for (const Pose2& pose : list) {
      x.push_back(pose.x);
      y.push_back(pose.y);
      yaw.push_back(pose.yaw);
    }
  }
  PoseBatch batch() const {
    return {x.data(), y.data(), yaw.data(), static_cast<Eigen::Index>(x.size())};
  }
  std::vector<double> x, y, yaw;
};

class RangeCasterContract : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<RangeCaster> makeCaster(const OccupancyGrid& grid, double max_range = 100.0,
                                          UnknownIs unknown_is = UnknownIs::kFree) const {
    RangeCasterParameters parameters;
    parameters.range_method = GetParam();
    parameters.max_range = max_range;
    parameters.unknown_is = unknown_is;
    return makeRangeCaster(grid, parameters);
  }

  static Eigen::ArrayXXf castAll(RangeCaster& caster, const std::vector<Pose2>& list,
                                 const Eigen::ArrayXf& bearings) {
    const Poses poses(list);
    Eigen::ArrayXXf ranges = Eigen::ArrayXXf::Constant(bearings.size(), poses.batch().size, -1.0F);
    caster.prepare(poses.batch(), bearings);
    caster.cast(poses.batch(), bearings, ranges);
    return ranges;
  }

  static double castOne(RangeCaster& caster, const Pose2& pose) {
    return static_cast<double>(castAll(caster, {pose}, Eigen::ArrayXf::Zero(1))(0, 0));
  }

  double tolerance(double resolution = 1.0) const {
    return promiseOf(GetParam()).flat_wall * resolution;
  }
};

TEST_P(RangeCasterContract, MeasuresARoomFromTheInside) {
  const auto caster = makeCaster(gridFromLines(kRoom));
  // Inner walls at x = 1 and 19, y = 1 and 7.
  const Pose2 pose{5.25, 2.5, 0.0};
  EXPECT_NEAR(castOne(*caster, pose), 13.75, tolerance());
  EXPECT_NEAR(castOne(*caster, {pose.x, pose.y, kPi / 2}), 4.5, tolerance());
  EXPECT_NEAR(castOne(*caster, {pose.x, pose.y, kPi}), 4.25, tolerance());
  EXPECT_NEAR(castOne(*caster, {pose.x, pose.y, -kPi / 2}), 1.5, tolerance());
  EXPECT_NEAR(castOne(*caster, {pose.x, pose.y, kPi / 4}), 4.5 * std::sqrt(2.0), 2 * tolerance());
  EXPECT_NEAR(castOne(*caster, {pose.x, pose.y, kPi / 4 + 6 * kPi}), 4.5 * std::sqrt(2.0),
              2 * tolerance());
}

TEST_P(RangeCasterContract, AddsTheBearingToTheYaw) {
  const auto caster = makeCaster(gridFromLines(kRoom));
  Eigen::ArrayXf bearings(3);
  bearings << static_cast<float>(-kPi / 2), 0.0F, static_cast<float>(kPi / 2);
  const Eigen::ArrayXXf ranges = castAll(*caster, {{5.25, 2.5, kPi / 2}, {8, 4, 0}}, bearings);
  EXPECT_NEAR(ranges(0, 0), 13.75, tolerance());
  EXPECT_NEAR(ranges(1, 0), 4.5, tolerance());
  EXPECT_NEAR(ranges(2, 0), 4.25, tolerance());
  EXPECT_NEAR(ranges(0, 1), 3.0, tolerance());
  EXPECT_NEAR(ranges(1, 1), 11.0, tolerance());
  EXPECT_NEAR(ranges(2, 1), 3.0, tolerance());
}

TEST_P(RangeCasterContract, HonoursResolutionAndTheOriginsPose) {
  const Pose2 origin{-3.0, 7.0, 3.14};
  const auto caster = makeCaster(gridFromLines(kRoom, 0.05, origin));
  const Pose2 in_grid{5.25 * 0.05, 2.5 * 0.05, 0.7};
  const Pose2 in_map = compose(origin, in_grid);
  const double to_top = 4.5 * 0.05 / std::sin(0.7);
  EXPECT_NEAR(castOne(*caster, in_map), to_top, 2 * tolerance(0.05));
  EXPECT_NEAR(castOne(*caster, {in_map.x, in_map.y, in_map.yaw - 0.7}), 13.75 * 0.05,
              tolerance(0.05));
}

TEST_P(RangeCasterContract, NeverExceedsMaxRange) {
  const auto caster = makeCaster(gridFromLines(kRoom), 5.0);
  EXPECT_FLOAT_EQ(castOne(*caster, {5.25, 2.5, 0.0}), 5.0F);
  EXPECT_NEAR(castOne(*caster, {5.25, 2.5, kPi}), 4.25, tolerance());
  const auto myopic = makeCaster(gridFromLines(kRoom), 0.25);
  EXPECT_FLOAT_EQ(castOne(*myopic, {5.25, 2.5, 0.3}), 0.25F);
}

TEST_P(RangeCasterContract, GivesZeroFromInsideAnObstacle) {
  const auto caster = makeCaster(gridFromLines(kRoom));
  for (const double yaw : {0.0, 1.0, 2.5, -2.0}) {
    EXPECT_EQ(castOne(*caster, {0.5, 3.2, yaw}), 0.0);
    EXPECT_EQ(castOne(*caster, {19.5, 7.5, yaw}), 0.0);
  }
}

TEST_P(RangeCasterContract, PassesThroughTheOutsideWhereUnknownIsFree) {
  const auto caster = makeCaster(gridFromLines({"...", "...", "..#", "...", "..."}), 50.0);
  EXPECT_FLOAT_EQ(castOne(*caster, {1.5, 1.5, 0.0}), 50.0F);            // out of the map
  EXPECT_NEAR(castOne(*caster, {-10.0, 2.5, 0.0}), 12.0, tolerance());  // in, and onto the wall
  EXPECT_NEAR(castOne(*caster, {20.0, 2.5, kPi}), 17.0, tolerance());
  EXPECT_NEAR(castOne(*caster, {2.5, 30.0, -kPi / 2}), 27.0, tolerance());
  EXPECT_NEAR(castOne(*caster, {2.5, -30.0, kPi / 2}), 32.0, tolerance());
  EXPECT_FLOAT_EQ(castOne(*caster, {-10.0, 1.5, 0.0}), 50.0F);   // across, past the wall
  EXPECT_FLOAT_EQ(castOne(*caster, {-10.0, 2.5, kPi}), 50.0F);   // away
  EXPECT_FLOAT_EQ(castOne(*caster, {-10.0, 20.0, 0.0}), 50.0F);  // beside the map
  EXPECT_FLOAT_EQ(castOne(*caster, {-49.0, 2.5, 0.0}), 50.0F);   // too far to see the wall
}

TEST_P(RangeCasterContract, EndsAtTheOutsideWhereUnknownIsOccupied) {
  const auto caster =
      makeCaster(gridFromLines({"...", "...", "..#", "...", "..."}), 50.0, UnknownIs::kOccupied);
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, 0.0}), 1.5, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, kPi}), 1.5, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, -kPi / 2}), 1.25, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, kPi / 2}), 3.75, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 2.25, 0.0}), 0.5, tolerance());
  EXPECT_EQ(castOne(*caster, {-10.0, 2.5, 0.0}), 0.0);
  EXPECT_EQ(castOne(*caster, {1.5, 100.0, 1.0}), 0.0);
}

TEST_P(RangeCasterContract, TakesUnknownCellsForWhatItIsTold) {
  const OccupancyGrid grid = gridFromLines({"######", "#..??#", "#..??#", "######"});
  EXPECT_NEAR(castOne(*makeCaster(grid), {1.5, 1.5, 0.0}), 3.5, tolerance());
  const auto caster = makeCaster(grid, 100.0, UnknownIs::kOccupied);
  EXPECT_NEAR(castOne(*caster, {1.5, 1.5, 0.0}), 1.5, tolerance());
  EXPECT_EQ(castOne(*caster, {4.0, 1.5, 0.0}), 0.0);
}

TEST_P(RangeCasterContract, AnswersPosesThatAreNotFiniteWithMaxRange) {
  for (const UnknownIs unknown_is : {UnknownIs::kFree, UnknownIs::kOccupied}) {
    const auto caster = makeCaster(gridFromLines(kRoom), 30.0, unknown_is);
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      EXPECT_FLOAT_EQ(castOne(*caster, {bad, 2.0, 0.0}), 30.0F);
      EXPECT_FLOAT_EQ(castOne(*caster, {2.0, bad, 0.0}), 30.0F);
      EXPECT_FLOAT_EQ(castOne(*caster, {2.0, 2.0, bad}), 30.0F);
      Eigen::ArrayXf bearings(2);
      bearings << static_cast<float>(bad), 0.0F;
      const Eigen::ArrayXXf ranges = castAll(*caster, {{5.25, 2.5, 0.0}}, bearings);
      EXPECT_FLOAT_EQ(ranges(0, 0), 30.0F);
      EXPECT_NEAR(ranges(1, 0), 13.75, tolerance());
    }
  }
}

TEST_P(RangeCasterContract, SurvivesHugeCoordinates) {
  for (const UnknownIs unknown_is : {UnknownIs::kFree, UnknownIs::kOccupied}) {
    const auto caster = makeCaster(gridFromLines(kRoom, 0.05, {1.0, 2.0, 0.3}), 30.0, unknown_is);
    const double outside = unknown_is == UnknownIs::kFree ? 30.0 : 0.0;
    for (const double far : {1e5, 1e10, 1e18, 1e38, 1e300, 1.7e308}) {
      for (const double yaw : {0.0, 1.0, kPi, -2.0}) {
        EXPECT_FLOAT_EQ(castOne(*caster, {far, 0.0, yaw}), outside);
        EXPECT_FLOAT_EQ(castOne(*caster, {0.0, -far, yaw}), outside);
        EXPECT_FLOAT_EQ(castOne(*caster, {-far, far, yaw}), outside);
      }
    }
    const double turned = castOne(*caster, {1.2, 2.3, 1e15});
    EXPECT_GE(turned, 0.0);
    EXPECT_LE(turned, 30.0);
  }
}

TEST_P(RangeCasterContract, AcceptsAMaxRangeFarBeyondTheMap) {
  const auto caster = makeCaster(gridFromLines(kRoom), 1e12);
  EXPECT_NEAR(castOne(*caster, {5.25, 2.5, 0.0}), 13.75, tolerance());
  const auto open = makeCaster(gridFromLines({"...", "...", "..."}), 1e12);
  EXPECT_FLOAT_EQ(castOne(*open, {1.5, 1.5, 0.4}), 1e12F);
}

TEST_P(RangeCasterContract, WorksOnASingleCell) {
  EXPECT_FLOAT_EQ(castOne(*makeCaster(gridFromLines({"."}), 9.0), {0.5, 0.5, 0.0}), 9.0F);
  EXPECT_EQ(castOne(*makeCaster(gridFromLines({"#"}), 9.0), {0.5, 0.5, 0.0}), 0.0);
  EXPECT_NEAR(castOne(*makeCaster(gridFromLines({"#"}), 9.0), {-1.5, 0.5, 0.0}), 1.5, tolerance());
}

TEST_P(RangeCasterContract, AcceptsNothingToDo) {
  const auto caster = makeCaster(gridFromLines(kRoom));
  EXPECT_EQ(castAll(*caster, {}, Eigen::ArrayXf::Zero(3)).size(), 0);
  EXPECT_EQ(castAll(*caster, {{5, 3, 0}}, Eigen::ArrayXf()).size(), 0);
}

TEST_P(RangeCasterContract, RefusesRangesOfAnotherShape) {
  const auto caster = makeCaster(gridFromLines(kRoom));
  const Poses poses({{5, 3, 0}, {6, 3, 0}});
  const Eigen::ArrayXf bearings = Eigen::ArrayXf::Zero(3);
  Eigen::ArrayXXf ranges(2, 3);
  caster->prepare(poses.batch(), bearings);
  EXPECT_THROW(caster->cast(poses.batch(), bearings, ranges), std::invalid_argument);
}

/// A map with scattered obstacles and unknown cells, and poses in, on the edge of and around it.
struct RandomWorld {
  explicit RandomWorld(std::uint64_t seed, int width, int height) : random(seed) {
    const GridGeometry geometry{width, height, 0.05, {-1.5, 0.7, 0.8}};
    std::vector<std::int8_t> cells(static_cast<std::size_t>(width * height));
    for (std::int8_t& cell : cells) {
      const double chance = random.uniform();
      cell = chance < 0.015  ? OccupancyGrid::kOccupied
             : chance < 0.02 ? OccupancyGrid::kUnknown
                             : OccupancyGrid::kFree;
    }
    grid = std::make_unique<OccupancyGrid>(geometry, std::move(cells));
  }

  std::vector<Pose2> poses(int count, double margin_cells) {
    const GridGeometry& geometry = grid->geometry();
    std::vector<Pose2> list;
    while (static_cast<int>(list.size()) < count) {
      const Eigen::Vector2d point =
          gridToWorld(geometry, {random.uniform(-margin_cells, geometry.width + margin_cells),
                                 random.uniform(-margin_cells, geometry.height + margin_cells)});
      list.push_back({point.x(), point.y(), random.uniform(-4.0, 4.0)});
    }
    return list;
  }

  Random random;
  std::unique_ptr<OccupancyGrid> grid;
};

Eigen::ArrayXf fan(int count) { return Eigen::ArrayXf::LinSpaced(count, -2.356F, 2.356F); }

TEST_P(RangeCasterContract, AgreesWithTheDefinitionOnRandomMaps) {
  const double max_range = 4.0;
  const Eigen::ArrayXf bearings = fan(40);
  for (const UnknownIs unknown_is : {UnknownIs::kFree, UnknownIs::kOccupied}) {
    std::vector<double> errors;
    for (const auto& [width, height] : {std::pair(120, 35), std::pair(40, 90)}) {
      RandomWorld world(7, width, height);
      const auto caster = makeCaster(*world.grid, max_range, unknown_is);
      const std::vector<Pose2> poses = world.poses(60, 3.0);
      const Eigen::ArrayXXf ranges = castAll(*caster, poses, bearings);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        for (Eigen::Index k = 0; k < bearings.size(); ++k) {
          const double expected = bruteForceRange(
              *world.grid, unknown_is, max_range,
              {poses[i].x, poses[i].y, poses[i].yaw + static_cast<double>(bearings[k])});
          const double got = static_cast<double>(ranges(k, static_cast<Eigen::Index>(i)));
          errors.push_back(std::abs(got - expected) / world.grid->geometry().resolution);
        }
      }
    }
    std::sort(errors.begin(), errors.end());
    const Promise promise = promiseOf(GetParam());
    const auto quantile = [&](double share) {
      return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
    };
    EXPECT_LE(quantile(0.95), promise.p95);
    EXPECT_LE(quantile(0.999), promise.p999);
    EXPECT_LE(quantile(1.0 - promise.over_three), 3.0);
  }
}

TEST_P(RangeCasterContract, CastsAChunkAsItCastsTheWhole) {
  RandomWorld world(8, 150, 100);
  const auto caster = makeCaster(*world.grid, 4.0);
  const Eigen::ArrayXf bearings = fan(37);
  const std::vector<Pose2> list = world.poses(101, 2.0);
  const Eigen::ArrayXXf whole = castAll(*caster, list, bearings);

  const Poses poses(list);
  Eigen::ArrayXXf chunks(whole.rows(), whole.cols());
  for (Eigen::Index first = 0; first < 101; first += 7) {
    const Eigen::Index count = std::min<Eigen::Index>(7, 101 - first);
    caster->cast(poses.batch().segment(first, count), bearings, chunks.middleCols(first, count));
  }
  EXPECT_TRUE((chunks == whole).all());
}

TEST_P(RangeCasterContract, CastsFromSeveralThreadsAtOnce) {
  RandomWorld world(9, 150, 100);
  const auto caster = makeCaster(*world.grid, 4.0);
  const Eigen::ArrayXf bearings = fan(50);
  const std::vector<Pose2> list = world.poses(200, 2.0);
  const Eigen::ArrayXXf whole = castAll(*caster, list, bearings);

  const Poses poses(list);
  std::vector<Eigen::ArrayXXf> results(4, Eigen::ArrayXXf(whole.rows(), whole.cols()));
  std::vector<std::thread> threads;
  for (Eigen::ArrayXXf& result : results) {
    threads.emplace_back([&, constant = static_cast<const RangeCaster*>(caster.get())] {
      constant->cast(poses.batch(), bearings, result);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Eigen::ArrayXXf& result : results) EXPECT_TRUE((result == whole).all());
}

TEST_P(RangeCasterContract, TellsItsMemory) {
  EXPECT_GE(makeCaster(gridFromLines(kRoom))->memoryBytes(), 160U);
}

INSTANTIATE_TEST_SUITE_P(EveryCaster, RangeCasterContract, testing::ValuesIn(rangeCasterNames()),
                         [](const auto& instance) { return instance.param; });

TEST(MakeRangeCaster, RefusesAnUnknownName) {
  RangeCasterParameters parameters;
  parameters.range_method = "crystal_ball";
  try {
    makeRangeCaster(gridFromLines(kRoom), parameters);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("crystal_ball"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("bresenham"), std::string::npos);
  }
}

TEST(MakeRangeCaster, RefusesARangeThatIsNotPositiveAndFinite) {
  for (const double bad : {0.0, -1.0, kInfinity, kNan}) {
    RangeCasterParameters parameters;
    parameters.max_range = bad;
    EXPECT_THROW(makeRangeCaster(gridFromLines(kRoom), parameters), ParameterError) << bad;
  }
}

TEST(MakeRangeCaster, KnowsItsDefaultMethod) {
  const std::vector<std::string> names = rangeCasterNames();
  EXPECT_NE(std::find(names.begin(), names.end(), RangeCasterParameters().range_method),
            names.end());
}

}  // namespace
}  // namespace racecar_mcl
