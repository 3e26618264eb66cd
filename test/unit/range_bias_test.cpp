#include "racecar_mcl/range_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/random.h"
#include "support/room.h"

namespace racecar_mcl {
namespace {

constexpr double kStep = 0.075;  // m between two scans

/// A car that drives a circle in a room whose walls stand at the centres of the cells that show
/// them, with a lidar whose ranges are all too long by the same.
class RangeBiasTest : public ::testing::Test {
 protected:
  static constexpr double kHalfCell = 0.025;  // m

  /// In the map: the room's corner at the cell centres.
  Pose2 truthAt(double travelled) const {
    return compose({4.0, 1.0, 0.0}, integrate({1.5, 0.0, 1.0}, travelled / 1.5));
  }

  Scan scanAt(double travelled, double too_long) const {
    const Room walls{room_.width + 2.0 * kHalfCell, room_.height + 2.0 * kHalfCell};
    const Pose2 in_map = truthAt(travelled);
    Scan scan = takeScan(walls, sweep_, travelled, [&](double) {
      return Pose2{in_map.x + kHalfCell, in_map.y + kHalfCell, in_map.yaw};
    });
    Random random(static_cast<std::uint64_t>(std::lround(travelled / kStep)) + 1);
    for (float& range : scan.ranges) {
      range += static_cast<float>(too_long + noise_ * random.gaussian());
    }
    return scan;
  }

  /// What is learned on the way. `lead`: where the car is taken to be, seen from where it is.
  double biasAfter(double metres, double too_long, const Pose2& lead = {},
                   const RangeBiasParameters& parameters = {}) const {
    RangeBias bias(parameters);
    for (double travelled = 0.0; travelled < metres; travelled += kStep) {
      Scan scan = scanAt(travelled, too_long);
      bias.correct(&scan);
      bias.learn(field_, compose(truthAt(travelled), lead), scan, kStep);
      EXPECT_LE(std::abs(bias.bias()), 0.1);
    }
    return bias.bias();
  }

  double noise_ = 0.02;  ///< m, the lidar's
  const Room room_;
  const Sweep sweep_{180, 4.7, 0.0, {0.27, 0.03, 0.05}};
  const LikelihoodField field_{room_.grid(2.0 * kHalfCell), {}};
};

TEST_F(RangeBiasTest, FindsByHowMuchRangesAreTooLong) {
  EXPECT_NEAR(biasAfter(20.0, 0.05), 0.05, 0.005);
  EXPECT_NEAR(biasAfter(20.0, -0.05), -0.05, 0.005);
}

TEST_F(RangeBiasTest, FindsNoneWhereThereIsNone) {
  EXPECT_NEAR(biasAfter(20.0, 0.0), 0.0, 0.005);
  RangeBiasParameters wrong;
  wrong.range_bias = 0.04;
  EXPECT_NEAR(biasAfter(20.0, 0.0, {}, wrong), 0.0, 0.005) << "nor does it keep a wrong one";
}

TEST_F(RangeBiasTest, IsNotMisledByAPoseThatLeads) {
  for (const double lead : {0.03, -0.03}) {
    EXPECT_NEAR(biasAfter(20.0, 0.0, {lead, 0.0, 0.0}), 0.0, 0.005) << lead;
    EXPECT_NEAR(biasAfter(20.0, 0.05, {lead, 0.0, 0.0}), 0.05, 0.005) << lead;
  }
}

TEST_F(RangeBiasTest, IsNotMisledByAPoseThatIsAsideOrTurned) {
  EXPECT_NEAR(biasAfter(20.0, 0.0, {0.0, 0.03, 0.0}), 0.0, 0.005);
  EXPECT_NEAR(biasAfter(20.0, 0.0, {0.0, 0.0, 0.01}), 0.0, 0.005);
}

TEST_F(RangeBiasTest, IsNeverMoreThanADecimetre) {
  EXPECT_LE(std::abs(biasAfter(20.0, 0.15)), 0.1);
  EXPECT_LE(std::abs(biasAfter(20.0, -0.15)), 0.1);
}

TEST_F(RangeBiasTest, IsKeptWhereItIsNotToBeLearned) {
  RangeBiasParameters off;
  off.range_bias_distance = 0.0;
  EXPECT_EQ(biasAfter(5.0, 0.05, {}, off), 0.0);
  off.range_bias = -0.03;
  EXPECT_EQ(biasAfter(5.0, 0.05, {}, off), -0.03);
}

TEST_F(RangeBiasTest, FollowsALidarThatChangesTheFasterTheShorterItsDistance) {
  const auto learnedOnTheWay = [&](double distance) {
    RangeBiasParameters parameters;
    parameters.range_bias_distance = distance;
    RangeBias bias(parameters);
    for (double travelled = 0.0; travelled < 60.0; travelled += kStep) {
      Scan scan = scanAt(travelled, travelled < 57.0 ? 0.0 : 0.05);
      bias.correct(&scan);
      bias.learn(field_, truthAt(travelled), scan, kStep);
    }
    return bias.bias();
  };
  EXPECT_NEAR(learnedOnTheWay(2.0), 0.05, 0.01);
  EXPECT_LT(learnedOnTheWay(200.0), 0.5 * learnedOnTheWay(2.0));
}

TEST(RangeBias, IsTakenFromEveryRangeAndLeavesThemAboveZero) {
  RangeBiasParameters parameters;
  parameters.range_bias = 0.05;
  Scan scan;
  scan.ranges = Eigen::ArrayXf(4);
  const float inf = std::numeric_limits<float>::infinity();
  scan.ranges << 1.0f, 0.2f, 0.02f, inf;
  RangeBias(parameters).correct(&scan);
  EXPECT_FLOAT_EQ(scan.ranges[0], 0.95f);
  EXPECT_FLOAT_EQ(scan.ranges[1], 0.15f);
  EXPECT_GT(scan.ranges[2], 0.0f);
  EXPECT_EQ(scan.ranges[3], inf);
}

TEST(RangeBias, LearnsNothingOfAScanThatMetNothing) {
  const Room room;
  const LikelihoodField field(room.grid(), {});
  Scan scan = takeScan(room, Sweep{}, 0.0, [](double) { return Pose2{4.0, 2.5, 0.0}; });
  RangeBias bias;
  for (const float nothing :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    scan.ranges.setConstant(nothing);
    bias.learn(field, {4.0, 2.5, 0.0}, scan, 1.0);
    EXPECT_EQ(bias.bias(), 0.0);
  }
}

TEST(RangeBiasParameters, OutOfRangeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate(RangeBiasParameters{}));
  EXPECT_NO_THROW(validate(RangeBiasParameters{-0.1, 0.0}));
  EXPECT_NO_THROW(validate(RangeBiasParameters{0.1, 1e6}));
  const RangeBiasParameters bad[] = {{0.11, 50.0}, {-0.11, 50.0}, {nan, 50.0},
                                     {0.0, -1.0},  {0.0, 1.1e6},  {0.0, nan}};
  for (const RangeBiasParameters& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(RangeBias{parameters}, ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
