#include "racecar_mcl/sensor/range_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/random.h"
#include "support/analytic_room.h"

namespace racecar_mcl {
namespace {

constexpr double kStep = 0.075;  // m between two scans

/// A car that drives a circle in a room whose walls are at cell centres, with a constant range
/// bias.
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
    for (Eigen::Index k = 0; k < scan.size(); ++k) {
      scan.ranges[k] += static_cast<float>(too_long + noise_ * random.gaussian());
    }
    return scan;
  }

  ScanScore scoreAt(const Pose2& base_in_map, const Scan& scan) const {
    return scanScore(field_, compose(base_in_map, scan.laser_in_base), scan);
  }

  /// The estimate after a drive. `lead`: the estimated pose in the frame of the true one.
  double biasAfter(double metres, double too_long, const Pose2& lead = {},
                   const RangeBiasParameters& parameters = {}) const {
    RangeBias bias(parameters);
    for (double travelled = 0.0; travelled < metres; travelled += kStep) {
      Scan scan = scanAt(travelled, too_long);
      scan.ranges -= static_cast<float>(bias.bias());
      bias.learn(scoreAt(compose(truthAt(travelled), lead), scan), kStep);
      EXPECT_LE(std::abs(bias.bias()), 0.1);
    }
    return bias.bias();
  }

  double noise_ = 0.02;  ///< m, the lidar's
  const Room room_;
  const Sweep sweep_{180, 4.7, 0.0, {0.27, 0.03, 0.05}};
  const LikelihoodField field_{room_.grid(2.0 * kHalfCell), {}};
};

TEST_F(RangeBiasTest, EstimatesTheBias) {
  EXPECT_NEAR(biasAfter(20.0, 0.05), 0.05, 0.005);
  EXPECT_NEAR(biasAfter(20.0, -0.05), -0.05, 0.005);
}

TEST_F(RangeBiasTest, EstimatesZeroWithoutBias) {
  EXPECT_NEAR(biasAfter(20.0, 0.0), 0.0, 0.005);
  RangeBiasParameters wrong;
  wrong.range_bias = 0.04;
  EXPECT_NEAR(biasAfter(20.0, 0.0, {}, wrong), 0.0, 0.005) << "a wrong initial value decays";
}

TEST_F(RangeBiasTest, IsRobustToAPoseErrorAlongThePath) {
  for (const double lead : {0.03, -0.03}) {
    EXPECT_NEAR(biasAfter(20.0, 0.0, {lead, 0.0, 0.0}), 0.0, 0.005) << lead;
    EXPECT_NEAR(biasAfter(20.0, 0.05, {lead, 0.0, 0.0}), 0.05, 0.005) << lead;
  }
}

TEST_F(RangeBiasTest, IsRobustToLateralAndHeadingErrors) {
  EXPECT_NEAR(biasAfter(20.0, 0.0, {0.0, 0.03, 0.0}), 0.0, 0.005);
  EXPECT_NEAR(biasAfter(20.0, 0.0, {0.0, 0.0, 0.01}), 0.0, 0.005);
}

TEST_F(RangeBiasTest, IsLimitedToADecimetre) {
  EXPECT_LE(std::abs(biasAfter(20.0, 0.15)), 0.1);
  EXPECT_LE(std::abs(biasAfter(20.0, -0.15)), 0.1);
}

TEST_F(RangeBiasTest, IsConstantIfDisabled) {
  RangeBiasParameters off;
  off.range_bias_distance = 0.0;
  EXPECT_EQ(biasAfter(5.0, 0.05, {}, off), 0.0);
  off.range_bias = -0.03;
  EXPECT_EQ(biasAfter(5.0, 0.05, {}, off), -0.03);
}

TEST_F(RangeBiasTest, ResumesWithinItsLimitsUnlessConstant) {
  RangeBias bias;
  bias.resume(0.03);
  EXPECT_EQ(bias.bias(), 0.03);
  bias.resume(0.5);
  EXPECT_EQ(bias.bias(), 0.1);
  RangeBiasParameters constant;
  constant.range_bias_distance = 0.0;
  RangeBias given(constant);
  given.resume(0.03);
  EXPECT_EQ(given.bias(), 0.0);
}

TEST_F(RangeBiasTest, FollowsAChangingBiasFasterWithAShorterDistance) {
  const auto learnedOnTheWay = [&](double distance) {
    RangeBiasParameters parameters;
    parameters.range_bias_distance = distance;
    RangeBias bias(parameters);
    for (double travelled = 0.0; travelled < 60.0; travelled += kStep) {
      Scan scan = scanAt(travelled, travelled < 57.0 ? 0.0 : 0.05);
      scan.ranges -= static_cast<float>(bias.bias());
      bias.learn(scoreAt(truthAt(travelled), scan), kStep);
    }
    return bias.bias();
  };
  EXPECT_NEAR(learnedOnTheWay(2.0), 0.05, 0.01);
  EXPECT_LT(learnedOnTheWay(200.0), 0.5 * learnedOnTheWay(2.0));
}

TEST(RangeBias, IsUnchangedByAScanWithoutReturns) {
  const Room room;
  const LikelihoodField field(room.grid(), {});
  Scan scan = takeScan(room, Sweep{}, 0.0, [](double) { return Pose2{4.0, 2.5, 0.0}; });
  RangeBias bias;
  for (const float nothing :
       {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    scan.ranges.setConstant(nothing);
    bias.learn(scanScore(field, {4.0, 2.5, 0.0}, scan), 1.0);
    EXPECT_EQ(bias.bias(), 0.0);
  }
}

TEST(RangeBiasParameters, OutOfRangeIsRejected) {
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
