#include "sim/raceline.h"

#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "support/ring_map.h"

namespace racecar_mcl::sim {
namespace {

/// Two straights of `length` m along the x axis, joined by half circles of `radius` m.
Path stadium(double length, double radius) {
  constexpr double kSpacing = 0.1;
  const double arc = kPi * radius;
  Path path;
  const auto add = [&](double way, double side) {
    const double angle = (way - length) / radius;
    const Eigen::Vector2d point =
        way < length
            ? Eigen::Vector2d(way - length / 2.0, -radius)
            : Eigen::Vector2d(length / 2.0 + radius * std::sin(angle), -radius * std::cos(angle));
    path.emplace_back(side * point);
  };
  for (const double side : {1.0, -1.0}) {
    for (double way = 0.0; way < length + arc - kSpacing / 2.0; way += kSpacing) add(way, side);
  }
  return path;
}

TEST(Raceline, GivesPlacesAroundTheLap) {
  const Raceline raceline(circle(3.0, 200), {});
  EXPECT_NEAR(raceline.length(), 6.0 * kPi, 0.01);
  const Pose2 quarter = raceline.poseAt(raceline.length() / 4.0);
  EXPECT_NEAR(quarter.x, 0.0, 0.01);
  EXPECT_NEAR(quarter.y, 3.0, 0.01);
  EXPECT_NEAR(std::abs(quarter.yaw), kPi, 0.04);
  for (const double along : {0.0, 1.0, 5.0, 18.0}) {
    for (const double lateral : {-0.4, 0.3}) {
      const Pose2 beside = compose(raceline.poseAt(along), {0.0, lateral, 0.0});
      const Raceline::Place place = raceline.placeOf({beside.x, beside.y});
      EXPECT_NEAR(std::remainder(place.along - along, raceline.length()), 0.0, 0.03);
      EXPECT_NEAR(place.lateral, lateral, 0.01);
    }
    EXPECT_NEAR(distance(raceline.poseAt(along), raceline.poseAt(along - raceline.length())), 0.0,
                1e-9);
  }
}

TEST(Raceline, LimitsTheSpeedOfACurveByTheGrip) {
  SpeedLimits limits;
  limits.grip = 4.5;
  const Raceline raceline(circle(2.0, 125), limits);
  EXPECT_NEAR(raceline.minSpeed(), 3.0, 0.03);
  EXPECT_NEAR(raceline.maxSpeed(), 3.0, 0.03);
}

TEST(Raceline, LimitsTheSpeedOfAStraight) {
  SpeedLimits limits;
  limits.max_speed = 5.0;
  const Raceline raceline(stadium(30.0, 2.0), limits);
  EXPECT_EQ(raceline.maxSpeed(), 5.0);
  EXPECT_LT(raceline.minSpeed(), 3.9);
}

TEST(Raceline, AcceleratesAndBrakesWithinTheLimits) {
  SpeedLimits limits;
  limits.max_speed = 20.0;
  limits.grip = 9.0;
  limits.max_acceleration = 3.0;
  limits.max_deceleration = 6.0;
  const Raceline raceline(stadium(20.0, 2.0), limits);
  EXPECT_LT(raceline.maxSpeed(), 13.0);
  double strongest = 0.0;
  double hardest = 0.0;
  for (double along = 0.0; along < raceline.length(); along += 0.1) {
    const double before = raceline.speedAt(along);
    const double after = raceline.speedAt(along + 0.1);
    const double acceleration = (after * after - before * before) / 0.2;
    strongest = std::max(strongest, acceleration);
    hardest = std::max(hardest, -acceleration);
  }
  EXPECT_NEAR(strongest, 3.0, 0.1);
  EXPECT_NEAR(hardest, 6.0, 0.2);
}

TEST(Raceline, RefusesWrongLimits) {
  SpeedLimits limits;
  limits.grip = 0.0;
  EXPECT_THROW(Raceline(circle(3.0, 100), limits), ParameterError);
  EXPECT_THROW(Raceline(circle(3.0, 4), {}), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
