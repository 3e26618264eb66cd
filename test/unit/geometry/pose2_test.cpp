#include "racecar_mcl/geometry/pose2.h"

#include <gtest/gtest.h>

#include "support/expect_pose.h"

namespace racecar_mcl {
namespace {

constexpr double kRounding = 1e-12;

TEST(WrapAngle, WrapsAnglesIntoTheHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(wrapAngle(0.5), 0.5);
  EXPECT_NEAR(wrapAngle(2 * kPi + 0.5), 0.5, 1e-12);
  EXPECT_NEAR(wrapAngle(-3 * kPi), kPi, 1e-12);
  EXPECT_DOUBLE_EQ(wrapAngle(-kPi), kPi);
}

TEST(Pose2, ComposeThenInverseIsIdentity) {
  const Pose2 a{1.0, -2.0, 2.5};
  expectNear(compose(a, inverse(a)), {}, kRounding);
  expectNear(compose(inverse(a), a), {}, kRounding);
}

TEST(Pose2, BetweenInvertsCompose) {
  const Pose2 a{1.0, -2.0, 2.5};
  const Pose2 b{-0.5, 4.0, -3.0};
  expectNear(compose(a, between(a, b)), b, kRounding);
}

TEST(Pose2, ComposeRotatesTheSecondByTheFirst) {
  expectNear(compose({1.0, 2.0, kPi / 2}, {3.0, 0.0, 0.0}), {1.0, 5.0, kPi / 2}, kRounding);
}

TEST(Integrate, DrivesAnArc) {
  // A quarter turn at 1 m/s on a circle of 2 m radius ends 2 m ahead and 2 m to the left.
  expectNear(integrate({1.0, 0.0, 0.5}, kPi), {2.0, 2.0, kPi / 2}, kRounding);
}

TEST(Integrate, ConvergesToAStraightLine) {
  expectNear(integrate({2.0, 0.5, 0.0}, 0.5), {1.0, 0.25, 0.0}, kRounding);
  expectNear(integrate({2.0, 0.5, 1e-5}, 0.5), integrate({2.0, 0.5, 3e-4}, 0.5), 2e-4);
}

TEST(Interpolate, InterpolatesYawAlongTheShorterArc) {
  expectNear(interpolate({0, 0, 3.0}, {2, 4, -3.0}, 0.5), {1, 2, kPi}, kRounding);
}

}  // namespace
}  // namespace racecar_mcl
