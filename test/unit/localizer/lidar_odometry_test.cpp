#include "racecar_mcl/localizer/lidar_odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "racecar_mcl/localizer/localizer.h"
#include "support/analytic_room.h"
#include "support/expect_pose.h"

namespace racecar_mcl {
namespace {

constexpr double kPeriod = 0.025;  // s
// Maximum error: one cell of the local map (0.05 m) and a centimetre of drift.
constexpr double kCell = 0.06;  // m

/// A car in a room, or between two infinitely long walls.
class LidarOdometryTest : public ::testing::Test {
 protected:
  Pose2 truthAt(double time) const { return compose(start_, integrate(twist_, time)); }

  Scan scanAt(double time) const {
    Scan scan = takeScan(room_, sweep_, time, [&](double t) { return truthAt(t); });
    scan.ranges = (scan.ranges > 30.0f).select(std::numeric_limits<float>::infinity(), scan.ranges);
    return scan;
  }

  /// Wheel odometry since the last scan, with a scale error.
  Motion motionTo(double time, double too_long) const {
    Motion motion;
    motion.delta = between(truthAt(time - kPeriod), truthAt(time));
    motion.delta.x *= 1.0 + too_long;
    motion.delta.y *= 1.0 + too_long;
    motion.distance = std::hypot(motion.delta.x, motion.delta.y);
    motion.rotation = std::abs(motion.delta.yaw);
    motion.seconds = kPeriod;
    motion.messages = 1.0;
    return motion;
  }

  struct Way {
    Pose2 refined;                                         ///< final pose
    Pose2 by_wheels;                                       ///< final pose
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< summed, in the car's frames
    Eigen::Matrix3d baseline = Eigen::Matrix3d::Zero();    ///< the motion model's, summed
    int matched = 0;                                       ///< number of scans
  };

  /// Drives over (0, seconds], from where the car is at time 0.
  Way drive(LidarOdometry* odometry, double seconds, double too_long) const {
    Way way;
    way.refined = way.by_wheels = truthAt(0.0);
    for (int i = 1; i <= std::lround(seconds / kPeriod); ++i) {
      const Motion motion = motionTo(i * kPeriod, too_long);
      const Motion refined = odometry->refine(motion, scanAt(i * kPeriod));
      way.refined = compose(way.refined, refined.delta);
      way.by_wheels = compose(way.by_wheels, motion.delta);
      way.baseline += motionCovariance(parameters_.motion, motion);
      if (!refined.covariance) continue;
      way.covariance += *refined.covariance;
      ++way.matched;
    }
    return way;
  }

  LidarOdometry fresh(std::uint64_t seed = 1) const {
    return {parameters_.filter, parameters_.motion, parameters_.sensor.field, seed};
  }

  LocalizerParameters parameters_;
  Room room_{12.0, 5.0};
  Sweep sweep_{240, 4.7, 0.0, {0.27, 0.03, 0.05}};
  Twist2 twist_{3.0, 0.0, 0.0};
  Pose2 start_{1.0, 2.3, 0.02};
};

TEST_F(LidarOdometryTest, ReturnsTheMotionUnchangedWithoutAKeyframe) {
  LidarOdometry odometry = fresh();
  const Motion motion = motionTo(kPeriod, 0.1);
  const Motion refined = odometry.refine(motion, scanAt(kPeriod));
  expectNear(refined.delta, motion.delta, 0.0);
  EXPECT_FALSE(refined.covariance);
  EXPECT_TRUE(odometry.refine(motionTo(2 * kPeriod, 0.1), scanAt(2 * kPeriod)).covariance)
      << "that scan was the first keyframe";
}

TEST_F(LidarOdometryTest, ChangesOnlyTheDeltaAndCovarianceOfAMotion) {
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  Motion motion = motionTo(kPeriod, 0.1);
  motion.noise_scale = 1.5;
  motion.twist_change = {0.1, 0.2, 0.3};
  const Motion refined = odometry.refine(motion, scanAt(kPeriod));
  EXPECT_EQ(refined.distance, motion.distance);
  EXPECT_EQ(refined.rotation, motion.rotation);
  EXPECT_EQ(refined.seconds, motion.seconds);
  EXPECT_EQ(refined.messages, motion.messages);
  EXPECT_EQ(refined.noise_scale, motion.noise_scale);
  EXPECT_EQ(refined.twist_change.vx, motion.twist_change.vx);
}

TEST_F(LidarOdometryTest, IsAccurateToCentimetresWithAccurateWheels) {
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  const Way way = drive(&odometry, 10.0 / 3.0, 0.0);
  expectNear(way.refined, truthAt(10.0 / 3.0), kCell, 0.01);
  EXPECT_EQ(way.matched, 133);
}

TEST_F(LidarOdometryTest, CorrectsMostOfATenthOfScaleError) {
  for (const double too_long : {0.1, -0.1}) {
    LidarOdometry odometry = fresh();
    odometry.remember(scanAt(0.0), truthAt(0.0));
    const Way way = drive(&odometry, 10.0 / 3.0, too_long);
    const Pose2 truth = truthAt(10.0 / 3.0);
    EXPECT_NEAR(distance(way.by_wheels, truth), 1.0, 0.03);
    expectNear(way.refined, truth, 0.1 + kCell, 0.01);
    EXPECT_NEAR(way.refined.y, truth.y, 0.04);
  }
}

TEST_F(LidarOdometryTest, FollowsACircle) {
  twist_ = {1.5, 0.0, 1.0};
  start_ = {6.0, 1.0, 0.0};
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  const Way way = drive(&odometry, 10.0 / 1.5, 0.1);
  expectNear(way.refined, truthAt(10.0 / 1.5), 0.1, 0.04);
}

TEST_F(LidarOdometryTest, StartsFromRememberedScans) {
  // In the frame of the remembered poses.
  const Pose2 elsewhere{50.0, -20.0, 2.0};
  LidarOdometry odometry = fresh();
  for (int i = -40; i <= 0; ++i) {
    odometry.remember(scanAt(i * kPeriod / 4.0), compose(elsewhere, truthAt(i * kPeriod / 4.0)));
  }
  const Way way = drive(&odometry, 1.0, 0.1);
  expectNear(way.refined, truthAt(1.0), 0.06, 0.01);
}

TEST_F(LidarOdometryTest, ReportsTheCovarianceOfAMatch) {
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  const Way way = drive(&odometry, 10.0 / 3.0, 0.0);
  const Pose2 error = between(truthAt(10.0 / 3.0), way.refined);
  EXPECT_LT(std::abs(error.x), 4.0 * std::sqrt(way.covariance(0, 0)));
  EXPECT_LT(std::sqrt(way.covariance(0, 0)), 0.1);
  EXPECT_LT(std::sqrt(way.covariance(1, 1)), 0.1);
  EXPECT_GT(way.covariance.diagonal().minCoeff(), 0.0);
}

TEST_F(LidarOdometryTest, KeepsTheOdometrysMotionAlongACorridorWithoutFeatures) {
  room_ = {1e6, 3.0};  // its ends are beyond the maximum range
  start_ = {5e5, 1.4, 0.0};
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  const Way way = drive(&odometry, 2.0, 0.1);
  const Pose2 truth = truthAt(2.0);
  EXPECT_NEAR(way.refined.x - start_.x, way.by_wheels.x - start_.x, 0.25);
  EXPECT_NEAR(way.refined.y, truth.y, 0.04);
  EXPECT_NEAR(way.refined.yaw, truth.yaw, 0.01);
}

TEST_F(LidarOdometryTest, CovarianceGrowsAlongACorridorWithoutFeatures) {
  LidarOdometry in_room = fresh();
  in_room.remember(scanAt(0.0), truthAt(0.0));
  const Way seen = drive(&in_room, 2.0, 0.0);

  room_ = {1e6, 3.0};
  start_ = {5e5, 1.4, 0.0};
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  const Way half = drive(&odometry, 1.0, 0.0);
  odometry.reset();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  const Way whole = drive(&odometry, 2.0, 0.0);
  EXPECT_GT(whole.covariance(0, 0), 1.5 * half.covariance(0, 0));
  EXPECT_GT(whole.covariance(0, 0), 1.3 * seen.covariance(0, 0));
  EXPECT_GT(whole.covariance(0, 0), 5.0 * whole.covariance(1, 1));
}

TEST_F(LidarOdometryTest, IsNoMoreCertainThanOdometryAlongACorridorWithoutFeatures) {
  room_ = {1e6, 3.0};
  start_ = {5e5, 1.4, 0.0};
  double share = 0.0;
  constexpr int kSeeds = 12;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    LidarOdometry odometry = fresh(seed);
    odometry.remember(scanAt(0.0), truthAt(0.0));
    const Way way = drive(&odometry, 2.0, 0.0);
    share += way.covariance(0, 0) / way.baseline(0, 0) / kSeeds;
  }
  EXPECT_GT(share, 0.8);
}

TEST_F(LidarOdometryTest, ResetRemovesKeyframes) {
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  ASSERT_TRUE(odometry.refine(motionTo(kPeriod, 0.0), scanAt(kPeriod)).covariance);
  odometry.reset();
  const Motion motion = motionTo(2 * kPeriod, 0.1);
  const Motion refined = odometry.refine(motion, scanAt(2 * kPeriod));
  expectNear(refined.delta, motion.delta, 0.0);
  EXPECT_FALSE(refined.covariance);
}

TEST_F(LidarOdometryTest, RestartsInTheMapsFrameAfterUse) {
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  drive(&odometry, 0.5, 0.1);
  // The pose has been corrected by the map since.
  const Pose2 corrected = compose(Pose2{0.4, 0.2, 0.1}, truthAt(0.0));
  odometry.remember(scanAt(0.0), corrected);
  const Way way = drive(&odometry, 0.5, 0.1);
  expectNear(way.refined, truthAt(0.5), kCell, 0.01);
}

TEST_F(LidarOdometryTest, HandlesScansWithoutReturns) {
  LidarOdometry odometry = fresh();
  odometry.remember(scanAt(0.0), truthAt(0.0));
  Scan nothing = scanAt(kPeriod);
  nothing.ranges.setConstant(std::numeric_limits<float>::infinity());
  const Motion motion = motionTo(kPeriod, 0.0);
  const Motion refined = odometry.refine(motion, nothing);
  expectNear(refined.delta, motion.delta, 0.03);
  for (int i = 2; i < 40; ++i) {
    ASSERT_TRUE(isFinite(odometry.refine(motionTo(i * kPeriod, 0.0), nothing).delta));
  }
}

TEST_F(LidarOdometryTest, KeepsKeyframesOfEachLidar) {
  // The rear lidar alone sees the wall behind: its scans measure the motion along the corridor.
  Sweep ahead{120, 1.0, 0.0, {0.27, 0.0, 0.0}};
  Sweep behind{120, 1.0, 0.0, {-0.1, 0.0, kPi}};
  room_ = {200.0, 2.0};
  start_ = {2.0, 1.0, 0.0};
  const auto scanOf = [&](int lidar, double time) {
    sweep_ = lidar == 0 ? ahead : behind;
    Scan scan = scanAt(time);
    scan.lidar = lidar;
    return scan;
  };
  LidarOdometry odometry = fresh();
  odometry.remember(scanOf(0, 0.0), truthAt(0.0));
  odometry.remember(scanOf(1, 0.0), truthAt(0.0));
  Pose2 refined = truthAt(0.0);
  for (int i = 1; i <= 100; ++i) {
    Motion motion = motionTo(i * kPeriod, 0.1);
    refined = compose(refined, odometry.refine(motion, scanOf(0, i * kPeriod)).delta);
    motion.delta = {};
    motion.distance = motion.rotation = motion.seconds = 0.0;
    refined = compose(refined, odometry.refine(motion, scanOf(1, i * kPeriod)).delta);
  }
  expectNear(refined, truthAt(100 * kPeriod), 0.15, 0.02);
}

}  // namespace
}  // namespace racecar_mcl
