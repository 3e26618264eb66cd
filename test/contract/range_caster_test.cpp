// Contract of all range casters: cases computed by hand.
#include "racecar_mcl/raycasting/range_caster.h"

#include <gtest/gtest.h>

#include <limits>

#include "caster_contract.h"
#include "racecar_mcl/common/errors.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const char* const kRoom = R"(
    ####################
    #..................#
    #..................#
    #..................#
    #..................#
    #..................#
    #..................#
    ####################)";

TEST_P(RangeCasterContract, MeasuresARoomFromTheInside) {
  const auto caster = makeCaster(asciiMap(kRoom));
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
  const auto caster = makeCaster(asciiMap(kRoom));
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
  const auto caster = makeCaster(asciiMap(kRoom, 0.05, origin));
  const Pose2 in_grid{5.25 * 0.05, 2.5 * 0.05, 0.7};
  const Pose2 in_map = compose(origin, in_grid);
  const double to_top = 4.5 * 0.05 / std::sin(0.7);
  EXPECT_NEAR(castOne(*caster, in_map), to_top, 2 * tolerance(0.05));
  EXPECT_NEAR(castOne(*caster, {in_map.x, in_map.y, in_map.yaw - 0.7}), 13.75 * 0.05,
              tolerance(0.05));
}

TEST_P(RangeCasterContract, NeverExceedsMaxRange) {
  const auto caster = makeCaster(asciiMap(kRoom), 5.0);
  EXPECT_FLOAT_EQ(castOne(*caster, {5.25, 2.5, 0.0}), 5.0F);
  EXPECT_NEAR(castOne(*caster, {5.25, 2.5, kPi}), 4.25, tolerance());
  const auto myopic = makeCaster(asciiMap(kRoom), 0.25);
  EXPECT_FLOAT_EQ(castOne(*myopic, {5.25, 2.5, 0.3}), 0.25F);
}

TEST_P(RangeCasterContract, GivesZeroInsideAnObstacle) {
  const auto caster = makeCaster(asciiMap(kRoom));
  for (const double yaw : {0.0, 1.0, 2.5, -2.0}) {
    EXPECT_EQ(castOne(*caster, {0.5, 3.2, yaw}), 0.0);
    EXPECT_EQ(castOne(*caster, {19.5, 7.5, yaw}), 0.0);
  }
}

TEST_P(RangeCasterContract, PassesThroughTheOutsideIfUnknownIsFree) {
  const auto caster = makeCaster(asciiMap("... ... ..# ... ..."), 50.0);
  EXPECT_FLOAT_EQ(castOne(*caster, {1.5, 1.5, 0.0}), 50.0F);            // out of the map
  EXPECT_NEAR(castOne(*caster, {-10.0, 2.5, 0.0}), 12.0, tolerance());  // in, and onto the wall
  EXPECT_NEAR(castOne(*caster, {20.0, 2.5, kPi}), 17.0, tolerance());
  EXPECT_NEAR(castOne(*caster, {2.5, 30.0, -kPi / 2}), 27.0, tolerance());
  EXPECT_NEAR(castOne(*caster, {2.5, -30.0, kPi / 2}), 32.0, tolerance());
  EXPECT_FLOAT_EQ(castOne(*caster, {-10.0, 1.5, 0.0}), 50.0F);   // across, past the wall
  EXPECT_FLOAT_EQ(castOne(*caster, {-10.0, 2.5, kPi}), 50.0F);   // away
  EXPECT_FLOAT_EQ(castOne(*caster, {-10.0, 20.0, 0.0}), 50.0F);  // beside the map
  EXPECT_FLOAT_EQ(castOne(*caster, {-49.0, 2.5, 0.0}), 50.0F);   // beyond the maximum range
}

TEST_P(RangeCasterContract, EndsAtTheOutsideIfUnknownIsOccupied) {
  const auto caster = makeCaster(asciiMap("... ... ..# ... ..."), 50.0, UnknownIs::kOccupied);
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, 0.0}), 1.5, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, kPi}), 1.5, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, -kPi / 2}), 1.25, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 1.25, kPi / 2}), 3.75, tolerance());
  EXPECT_NEAR(castOne(*caster, {1.5, 2.25, 0.0}), 0.5, tolerance());
  EXPECT_EQ(castOne(*caster, {-10.0, 2.5, 0.0}), 0.0);
  EXPECT_EQ(castOne(*caster, {1.5, 100.0, 1.0}), 0.0);
}

TEST_P(RangeCasterContract, TreatsUnknownCellsAsConfigured) {
  const OccupancyGrid grid = asciiMap("###### #..??# #..??# ######");
  EXPECT_NEAR(castOne(*makeCaster(grid), {1.5, 1.5, 0.0}), 3.5, tolerance());
  const auto caster = makeCaster(grid, 100.0, UnknownIs::kOccupied);
  EXPECT_NEAR(castOne(*caster, {1.5, 1.5, 0.0}), 1.5, tolerance());
  EXPECT_EQ(castOne(*caster, {4.0, 1.5, 0.0}), 0.0);
}

TEST_P(RangeCasterContract, GivesMaxRangeForPosesThatAreNotFinite) {
  for (const UnknownIs unknown_is : {UnknownIs::kFree, UnknownIs::kOccupied}) {
    const auto caster = makeCaster(asciiMap(kRoom), 30.0, unknown_is);
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
    const auto caster = makeCaster(asciiMap(kRoom, 0.05, {1.0, 2.0, 0.3}), 30.0, unknown_is);
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
  const auto caster = makeCaster(asciiMap(kRoom), 1e12);
  EXPECT_NEAR(castOne(*caster, {5.25, 2.5, 0.0}), 13.75, tolerance());
  const auto open = makeCaster(asciiMap("... ... ..."), 1e12);
  EXPECT_FLOAT_EQ(castOne(*open, {1.5, 1.5, 0.4}), 1e12F);
}

TEST_P(RangeCasterContract, WorksOnASingleCell) {
  EXPECT_FLOAT_EQ(castOne(*makeCaster(asciiMap("."), 9.0), {0.5, 0.5, 0.0}), 9.0F);
  EXPECT_EQ(castOne(*makeCaster(asciiMap("#"), 9.0), {0.5, 0.5, 0.0}), 0.0);
  EXPECT_NEAR(castOne(*makeCaster(asciiMap("#"), 9.0), {-1.5, 0.5, 0.0}), 1.5, tolerance());
}

TEST_P(RangeCasterContract, AcceptsEmptyBatches) {
  const auto caster = makeCaster(asciiMap(kRoom));
  EXPECT_EQ(castAll(*caster, {}, Eigen::ArrayXf::Zero(3)).size(), 0);
  EXPECT_EQ(castAll(*caster, {{5, 3, 0}}, Eigen::ArrayXf()).size(), 0);
}

TEST_P(RangeCasterContract, RejectsRangesOfAnotherShape) {
  const auto caster = makeCaster(asciiMap(kRoom));
  const Poses poses({{5, 3, 0}, {6, 3, 0}});
  const Eigen::ArrayXf bearings = Eigen::ArrayXf::Zero(3);
  Eigen::ArrayXXf ranges(2, 3);
  caster->prepare(poses.batch(), bearings);
  EXPECT_THROW(caster->cast(poses.batch(), bearings, ranges), std::invalid_argument);
}

TEST_P(RangeCasterContract, ReportsItsMemory) {
  EXPECT_GE(makeCaster(asciiMap(kRoom))->memoryBytes(), 160U);
}

INSTANTIATE_TEST_SUITE_P(EveryCaster, RangeCasterContract, testing::ValuesIn(subjects()),
                         [](const auto& instance) { return instance.param.name; });

TEST(MakeRangeCaster, RejectsAnUnknownName) {
  RangeCasterParameters parameters;
  parameters.range_method = "crystal_ball";
  try {
    makeRangeCaster(asciiMap(kRoom), parameters);
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("crystal_ball"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("bresenham"), std::string::npos);
  }
}

TEST(MakeRangeCaster, RejectsARangeThatIsNotPositiveAndFinite) {
  for (const double bad : {0.0, -1.0, kInfinity, kNan}) {
    RangeCasterParameters parameters;
    parameters.max_range = bad;
    EXPECT_THROW(makeRangeCaster(asciiMap(kRoom), parameters), ParameterError) << bad;
  }
}

TEST(MakeRangeCaster, HasItsDefaultMethod) {
  const std::vector<std::string> names = rangeCasterNames();
  EXPECT_NE(std::find(names.begin(), names.end(), RangeCasterParameters().range_method),
            names.end());
}

}  // namespace
}  // namespace racecar_mcl
