#include "racecar_mcl/sensor/likelihood_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/common/errors.h"
#include "support/analytic_room.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

LikelihoodFieldParameters plain() { return {0.2, 0.05, 10.0, 1.0}; }

// Half a step of the stored values.
const double kRounding = 0.51 * -std::log(plain().z_rand) / 255.0;

Scan oneBeam(float bearing, float range) {
  Scan scan;
  scan.bearings = Eigen::ArrayXf::Constant(1, bearing);
  scan.ranges = Eigen::ArrayXf::Constant(1, range);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(1);
  return scan;
}

double logLikelihoodOf(const LikelihoodField& field, const Pose2& lidar, const Scan& scan) {
  Eigen::ArrayXd result(1);
  field.logLikelihood({&lidar.x, &lidar.y, &lidar.yaw, 1}, scan, result);
  return result[0];
}

double formula(const LikelihoodFieldParameters& p, double distance) {
  return std::log((1.0 - p.z_rand) / (1.0 + std::pow(distance / p.field_scale, 2)) + p.z_rand) *
         p.likelihood_exponent;
}

const char* const kWallOnTheRight = R"(
    .........#
    .........#
    .........#
    .........#
    .........#)";

TEST(LikelihoodField, DependsOnTheDistanceOfTheEndPointFromTheWall) {
  const LikelihoodField field(asciiMap(kWallOnTheRight, 0.1), plain());
  // The wall's cells have their centres at x = 0.95; ends on cell centres need no interpolation.
  const Pose2 lidar{0.05, 0.25, 0.0};
  for (const int cells : {0, 1, 2, 5, 8}) {
    const auto range = static_cast<float>(0.9 - 0.1 * cells);
    EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, range)), formula(plain(), 0.1 * cells),
                kRounding);
  }
}

// The surface's cells have their centres at x = 0.45; cells behind them are not visible.
constexpr const char* kThickWallOnTheRight = R"(
    ....######
    ....######
    ....######
    ....######
    ....######
    ....######
    ....######)";

TEST(LikelihoodField, IsWiderInsideAThickWall) {
  LikelihoodFieldParameters p = plain();
  const Pose2 lidar{0.05, 0.35, 0.0};
  for (const double inside : {0.0, 0.5, 1.0}) {
    p.inside_wall_factor = inside;
    const LikelihoodField field(asciiMap(kThickWallOnTheRight, 0.1), p);
    EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.2f)), formula(p, 0.2), kRounding);
    EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.4f)), formula(p, 0.0), kRounding);
    EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.6f)), formula(p, 0.2 * inside),
                kRounding);
  }
}

TEST(LikelihoodField, ReachesThroughAThickWallWithASmallScale) {
  LikelihoodFieldParameters p = plain();
  p.field_scale = 0.005;
  p.inside_wall_factor = 0.1;
  const LikelihoodField field(asciiMap(kThickWallOnTheRight, 0.1), p);
  EXPECT_NEAR(logLikelihoodOf(field, {0.05, 0.35, 0.0}, oneBeam(0.0f, 0.8f)), formula(p, 0.04),
              kRounding);
}

TEST(LikelihoodField, IsSymmetricInsideAThinWall) {
  LikelihoodFieldParameters p = plain();
  p.inside_wall_factor = 0.5;
  // The same cells, half as large.
  const LikelihoodField field(asciiMap(kThickWallOnTheRight, 0.05), p);
  const Pose2 lidar{0.025, 0.175, 0.0};
  EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.2f)), formula(p, 0.0), kRounding);
  EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.3f)), formula(p, 0.1), kRounding);
}

// A wall at 45 degrees is the diagonal cells; those behind touch free space only at corners.
TEST(LikelihoodField, HasASlantingWallOneCellThick) {
  constexpr const char* kSlantingWall = R"(
    #####
    .####
    ..###
    ...##
    ....#)";
  const LikelihoodField field(asciiMap(kSlantingWall, 0.1), plain());
  const Pose2 lidar{0.45, 0.05, 0.0};  // in the wall's lower right end
  const auto at = [&](double x, double y) {
    const auto bearing = static_cast<float>(std::atan2(y - lidar.y, x - lidar.x));
    const auto range = static_cast<float>(std::hypot(x - lidar.x, y - lidar.y));
    return logLikelihoodOf(field, lidar, oneBeam(bearing, range));
  };
  EXPECT_NEAR(at(0.25, 0.25), formula(plain(), 0.0), kRounding);
  EXPECT_NEAR(at(0.15, 0.15), formula(plain(), 0.1 * std::sqrt(2.0)), kRounding);
  EXPECT_NEAR(at(0.25, 0.35), formula(plain(), 0.1), kRounding);
  EXPECT_NEAR(at(0.35, 0.35), formula(plain(), 0.1 * std::sqrt(2.0)), kRounding);
}

TEST(LikelihoodField, ContinuesBehindAWallAtTheMapsEdge) {
  const LikelihoodField field(asciiMap(kWallOnTheRight, 0.1), plain());
  const Pose2 lidar{0.05, 0.25, 0.0};
  for (const int cells : {1, 3, 7}) {
    EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.9f + 0.1f * cells)),
                formula(plain(), 0.1 * cells), kRounding);
  }
}

TEST(LikelihoodField, InterpolatesBetweenCellCentres) {
  const LikelihoodField field(asciiMap(kWallOnTheRight, 0.1), plain());
  const Pose2 lidar{0.05, 0.27, 0.0};
  const double expected = 0.75 * formula(plain(), 0.2) + 0.25 * formula(plain(), 0.1);
  EXPECT_NEAR(logLikelihoodOf(field, lidar, oneBeam(0.0f, 0.725f)), expected, kRounding);
}

TEST(LikelihoodField, SumsBeamsAndAppliesTheExponent) {
  LikelihoodFieldParameters correlated = plain();
  correlated.likelihood_exponent = 0.25;
  const LikelihoodField field(asciiMap(kWallOnTheRight, 0.1), correlated);
  Scan scan = oneBeam(0.0f, 0.7f);
  scan.bearings = Eigen::ArrayXf::Zero(2);
  scan.ranges.resize(2);
  scan.ranges << 0.7f, 0.4f;
  EXPECT_NEAR(logLikelihoodOf(field, {0.05, 0.25, 0.0}, scan),
              (formula(plain(), 0.2) + formula(plain(), 0.5)) / 4.0, kRounding);
}

TEST(LikelihoodField, BeamLogLikelihoodsSumToThatOfTheScan) {
  const Room room;
  const LikelihoodField field(room.grid(), plain());
  const Pose2 lidar{2.0, 3.0, 0.4};
  Sweep sweep;
  sweep.count = 600;
  Scan scan = takeScan(room, sweep, 0.0, [&](double) { return lidar; });
  for (Eigen::Index k = 0; k < 600; k += 7) scan.ranges[k] *= 0.8f;
  scan.ranges[1] = std::numeric_limits<float>::infinity();
  scan.ranges[299] = std::numeric_limits<float>::quiet_NaN();
  const Eigen::ArrayXf each = field.beamLogLikelihoods(lidar, scan);
  ASSERT_EQ(each.size(), 600);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < 600; ++k) {
    const bool weighed = scan.ranges[k] < 10.0f;
    ASSERT_EQ(std::isnan(each[k]), !weighed) << k;
    if (weighed) sum += static_cast<double>(each[k]);
  }
  EXPECT_NEAR(logLikelihoodOf(field, lidar, scan), sum, 1e-3);
}

TEST(LikelihoodField, EndPointsOutsideTheMapAreRandom) {
  const LikelihoodField field(asciiMap(kWallOnTheRight, 0.1), plain());
  const double chance = std::log(plain().z_rand);
  EXPECT_NEAR(logLikelihoodOf(field, {0.05, 0.25, 0.0}, oneBeam(0.0f, 5.0f)), chance, 1e-6);
  EXPECT_NEAR(logLikelihoodOf(field, {0.05, 0.25, 2.0}, oneBeam(0.0f, 5.0f)), chance, 1e-6);
  EXPECT_NEAR(logLikelihoodOf(field, {1e9, 0.25, 0.0}, oneBeam(0.0f, 0.5f)), chance, 1e-6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(logLikelihoodOf(field, {nan, 0.25, nan}, oneBeam(0.0f, 0.5f)), chance, 1e-6);
}

TEST(LikelihoodField, IgnoresBeamsWithoutReturn) {
  const LikelihoodField field(asciiMap(kWallOnTheRight, 0.1), plain());
  for (const float far : {10.0f, 50.0f, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(logLikelihoodOf(field, {0.05, 0.25, 0.0}, oneBeam(0.0f, far)), 0.0);
  }
}

TEST(LikelihoodField, HandlesAMapWithoutObstacles) {
  const LikelihoodField field(asciiMap("....", 0.1), plain());
  EXPECT_NEAR(logLikelihoodOf(field, {0.05, 0.05, 0.0}, oneBeam(0.0f, 0.2f)),
              std::log(plain().z_rand), 1e-6);
}

TEST(LikelihoodField, PrefersTheTruePoseOnARotatedGrid) {
  // The room's grid, rotated and shifted, with the lidar at the same place inside.
  const Room room;
  const OccupancyGrid straight = room.grid();
  const Pose2 room_in_map{3.0, -2.0, 2.5};
  GridGeometry geometry = straight.geometry();
  geometry.origin = compose(room_in_map, geometry.origin);
  const LikelihoodField field(OccupancyGrid(geometry, straight.cells()), plain());
  const Pose2 lidar_in_room{2.0, 3.0, 0.4};
  const Scan scan = takeScan(room, Sweep{}, 0.0, [&](double) { return lidar_in_room; });
  const double at_truth = logLikelihoodOf(field, compose(room_in_map, lidar_in_room), scan);
  for (const Pose2& off : {Pose2{0.2, 0.0, 0.0}, Pose2{-0.2, 0.0, 0.0}, Pose2{0.0, 0.2, 0.0},
                           Pose2{0.0, -0.2, 0.0}, Pose2{0.0, 0.0, 0.1}, Pose2{0.0, 0.0, -0.1}}) {
    EXPECT_GT(at_truth, 1.0 + logLikelihoodOf(
                                  field, compose(room_in_map, compose(lidar_in_room, off)), scan));
  }
}

TEST(LikelihoodFieldParameters, RejectValuesOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(validate(LikelihoodFieldParameters{}));
  const LikelihoodFieldParameters bad[] = {
      {0.0, 0.05, 10.0, 1.0},       {-0.1, 0.05, 10.0, 1.0},     {nan, 0.05, 10.0, 1.0},
      {1e-300, 0.05, 10., 1.},      {0.2, 0.0, 10.0, 1.0},       {0.2, 1.0, 10.0, 1.0},
      {0.2, nan, 10.0, 1.0},        {0.2, 0.05, 0.0, 1.0},       {0.2, 0.05, inf, 1.0},
      {0.2, 0.05, 10.0, 0.0},       {0.2, 0.05, 10.0, -6.0},     {0.2, 0.05, 10.0, 1e-300},
      {0.2, 0.05, 10.0, 1.0, -0.1}, {0.2, 0.05, 10.0, 1.0, 1.1}, {0.2, 0.05, 10.0, 1.0, nan}};
  for (const LikelihoodFieldParameters& parameters : bad) {
    EXPECT_THROW(validate(parameters), ParameterError);
    EXPECT_THROW(LikelihoodField(asciiMap(kWallOnTheRight, 0.1), parameters), ParameterError);
  }
}

}  // namespace
}  // namespace racecar_mcl
