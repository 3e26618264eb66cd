#include "sim/lidar.h"

#include <gtest/gtest.h>

#include <memory>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/scan/deskew.h"
#include "support/ascii_map.h"

namespace racecar_mcl::sim {
namespace {

/// A room of 8 m x 5 m, free from (1, 1) to (9, 6).
World room() {
  return World(asciiMap(R"(
      ##########
      #........#
      #........#
      #........#
      #........#
      #........#
      ##########)"));
}

LidarParameters exact() {
  LidarParameters parameters;
  parameters.range_noise = 0.0;
  parameters.missing_rate = 0.0;
  return parameters;
}

LidarScan sweepOnce(const LidarParameters& parameters, const Arc& arc,
                    const std::vector<Obstacle>& obstacles = {}, std::uint64_t seed = 1) {
  Lidar lidar(parameters, seed, arc.begin);
  const auto sweep = lidar.measure(arc, room(), obstacles);
  EXPECT_TRUE(sweep.has_value());
  return sweep.value_or(LidarScan{});
}

Arc moving(const Pose2& base_in_map, const Twist2& twist) {
  return {0.0, 0.024, base_in_map, twist};
}

/// The largest distance of end points from the room's walls, for a lidar at `laser_in_map`.
double worstMiss(const Scan& scan, const Pose2& laser_in_map) {
  double worst = 0.0;
  for (Eigen::Index i = 0; i < scan.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    const double yaw = laser_in_map.yaw + static_cast<double>(scan.bearings[i]);
    const double x = laser_in_map.x + range * std::cos(yaw);
    const double y = laser_in_map.y + range * std::sin(yaw);
    const double miss = std::min(std::min(std::abs(x - 1.0), std::abs(x - 9.0)),
                                 std::min(std::abs(y - 1.0), std::abs(y - 6.0)));
    worst = std::max(worst, miss);
  }
  return worst;
}

TEST(Lidar, LooksLikeAHokuyo) {
  const LidarScan sweep = sweepOnce(exact(), moving({3.0, 3.0, 0.0}, {}));
  EXPECT_EQ(sweep.ranges.size(), 1081u);
  EXPECT_NEAR(sweep.angle_min, -0.75 * kPi, 1e-12);
  EXPECT_NEAR(sweep.angle_increment, kPi / 720.0, 1e-12);
  EXPECT_NEAR(sweep.time_increment, 0.025 / 1440.0, 1e-12);
  EXPECT_NEAR(sweep.arrival - sweep.stamp, 0.01875, 1e-12);
  EXPECT_NEAR(sweep.scan_time, 0.025, 1e-12);
  // 0.27 m ahead of base_link, 5.73 m from the wall.
  EXPECT_NEAR(sweep.ranges[540], 5.73, 1e-6);
}

TEST(Lidar, EveryBeamIsTakenFromWhereTheCarIsAtThatTime) {
  // 7 m/s towards the wall: the middle beam is 9.375 ms after the stamp, 6.56 cm further ahead.
  const LidarScan sweep = sweepOnce(exact(), moving({3.0, 3.0, 0.0}, {7.0, 0.0, 0.0}));
  EXPECT_NEAR(sweep.ranges[540], 5.73 - 7.0 * 0.009375, 1e-6);
  // To the right (beam 180) the distance to the wall is constant.
  EXPECT_NEAR(sweep.ranges[180], 2.0, 1e-6);
}

TEST(Lidar, ASweepInMotionIsBentAndDeskewStraightensIt) {
  const Pose2 start{3.0, 2.5, 0.4};
  const Twist2 twist{7.0, 0.0, 3.0};
  const Scan scan = toScan(sweepOnce(exact(), moving(start, twist)));
  const Pose2 laser_in_map = compose(start, scan.laser_in_base);
  EXPECT_GT(worstMiss(scan, laser_in_map), 0.10);
  const Scan straight = deskew(scan, [&](double t) { return integrate(twist, t); });
  EXPECT_LT(worstMiss(straight, laser_in_map), 1e-5);
}

TEST(Lidar, AClockwiseSweepIsListedAgainstTheTime) {
  LidarParameters parameters = exact();
  parameters.clockwise = true;
  const Arc arc = moving({3.0, 3.0, 0.3}, {3.0, 0.0, 2.0});
  const LidarScan sweep = sweepOnce(parameters, arc);
  EXPECT_DOUBLE_EQ(sweep.stamp, sweep.arrival);
  EXPECT_NEAR(sweep.stamp, parameters.sweep_time, 1e-9);
  EXPECT_GT(sweep.angle_increment, 0.0);
  EXPECT_GT(sweep.time_increment, 0.0) << "as reported by drivers";

  Scan scan = toScan(sweep);
  const Pose2 base = arc.at(sweep.stamp);
  const auto straightened = [&](const Scan& listed) {
    return deskew(listed,
                  [&](double seconds) { return between(base, arc.at(sweep.stamp + seconds)); });
  };
  const Pose2 laser = compose(base, sweep.laser_in_base);
  EXPECT_GT(worstMiss(straightened(scan), laser), 0.1);
  scan.seconds_after_stamp = -scan.seconds_after_stamp;
  EXPECT_LT(worstMiss(straightened(scan), laser), 0.005);
}

TEST(Lidar, AnInstantSweepIsNotBent) {
  LidarParameters parameters = exact();
  parameters.instant = true;
  const Pose2 start{3.0, 2.5, 0.4};
  const LidarScan sweep = sweepOnce(parameters, moving(start, {7.0, 0.0, 3.0}));
  EXPECT_EQ(sweep.time_increment, 0.0);
  EXPECT_EQ(sweep.arrival, sweep.stamp);
  const Scan scan = toScan(sweep);
  EXPECT_LT(worstMiss(scan, compose(start, scan.laser_in_base)), 1e-5);
}

TEST(Lidar, NoiseHasItsSigma) {
  LidarParameters parameters = exact();
  parameters.range_noise = 0.02;
  const Arc standing = moving({5.0, 3.0, 0.3}, {});
  const LidarScan truth = sweepOnce(exact(), standing);
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const LidarScan noisy = sweepOnce(parameters, standing, {}, seed);
    for (std::size_t i = 0; i < noisy.ranges.size(); ++i, ++count) {
      const double error = static_cast<double>(noisy.ranges[i] - truth.ranges[i]);
      sum += error;
      squares += error * error;
    }
  }
  EXPECT_NEAR(sum / count, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 0.0005);
}

TEST(Lidar, BiasIsAddedToEveryRange) {
  LidarParameters biased = exact();
  biased.range_bias = -0.03;
  const Arc arc = moving({5.0, 3.5, 0.3}, {});
  const LidarScan unbiased_sweep = sweepOnce(exact(), arc);
  const LidarScan sweep = sweepOnce(biased, arc);
  ASSERT_EQ(sweep.ranges.size(), unbiased_sweep.ranges.size());
  for (std::size_t i = 0; i < sweep.ranges.size(); ++i) {
    EXPECT_NEAR(sweep.ranges[i], unbiased_sweep.ranges[i] - 0.03F, 1e-5F);
  }
}

TEST(Lidar, MissingReturnsFarWallsAndGlassAreInfinite) {
  const auto infinite = [](const LidarScan& sweep) {
    int count = 0;
    for (const float range : sweep.ranges) count += std::isinf(range) && range > 0.0f ? 1 : 0;
    return count;
  };
  const Arc standing = moving({5.0, 3.0, 0.3}, {});
  LidarParameters parameters = exact();
  EXPECT_EQ(infinite(sweepOnce(parameters, standing)), 0);
  parameters.missing_rate = 0.1;
  EXPECT_NEAR(infinite(sweepOnce(parameters, standing)), 108, 30);
  parameters = exact();
  parameters.glass = {1.0, 0.5, 1};
  EXPECT_EQ(infinite(sweepOnce(parameters, standing)), 1081);
  parameters = exact();
  parameters.range_max = 3.0;
  const LidarScan near = sweepOnce(parameters, standing);
  EXPECT_GT(infinite(near), 100);
  for (const float range : near.ranges) EXPECT_TRUE(std::isinf(range) || range <= 3.0f);
}

TEST(Lidar, WhatIsTooCloseIsMinusInfinityAndNoScanPoint) {
  const LidarScan sweep = sweepOnce(exact(), moving({8.70, 3.0, 0.0}, {}));  // 3 cm from the wall
  EXPECT_TRUE(std::isinf(sweep.ranges[540]) && sweep.ranges[540] < 0.0f);
  const Scan scan = toScan(sweep);
  EXPECT_LT(scan.size(), 1081);
  EXPECT_TRUE((scan.ranges > 0.0f).all());
}

TEST(Lidar, SeesObstaclesWhereTheyAreAtEachBeamsTime) {
  Obstacle walker;
  walker.radius = 0.3;
  walker.path = {{6.0, 3.0}, {4.0, 3.0}};
  walker.speed = 8.0;
  const LidarScan sweep = sweepOnce(exact(), moving({2.0, 3.0, 0.0}, {}), {walker});
  EXPECT_NEAR(sweep.ranges[540], 6.0 - 8.0 * 0.009375 - 0.3 - 2.27, 1e-6);
}

TEST(Lidar, RefusesWhatCannotBe) {
  LidarParameters parameters;
  parameters.sweep_time = 0.03;  // longer than the 25 ms between sweeps
  EXPECT_THROW(parameters.validate(), ParameterError);
  parameters = {};
  parameters.beams = 1;
  EXPECT_THROW(parameters.validate(), ParameterError);
  parameters = {};
  parameters.missing_rate = 1.5;
  EXPECT_THROW(parameters.validate(), ParameterError);
  parameters = {};
  parameters.range_noise = std::nan("");
  EXPECT_THROW(parameters.validate(), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
