#include "racecar_mcl/motion/distance_scale.h"

#include <gtest/gtest.h>

#include <cmath>

#include "racecar_mcl/geometry/pose2.h"

namespace racecar_mcl {
namespace {

constexpr double kStep = 0.1;          // m per scan
constexpr double kOdometryVar = 1e-5;  // m^2 per scan, of the motion noise

Motion motionOf(double length, double yaw = 0.0) {
  Motion motion;
  motion.delta = {length, 0.0, yaw};
  motion.distance = std::abs(length);
  return motion;
}

/// A car on a course whose scans measure the position along with this standard deviation; the pose
/// is estimated by a Kalman filter, as by particles. The odometry measures `measured` metres per
/// true metre.
class Course {
 public:
  Course(double sigma, double measured) : noise_(sigma * sigma), measured_(measured) {}

  void drive(double metres, DistanceScale* scale, bool map_is_complete = true,
             bool is_explained = true) {
    const double step = std::copysign(kStep, metres);
    for (double driven = 0.0; driven < std::abs(metres); driven += kStep) {
      const double length = scale->scale() * measured_ * step;
      lead_ += length - step;
      const double before = variance_ + kOdometryVar + scale->varianceAlong(length);
      const double gain = before / (before + noise_);
      variance_ = (1.0 - gain) * before;
      PoseCorrection correction;
      correction.pose = {-gain * lead_, 0.0, 0.0};
      correction.before = Eigen::Vector2d(before, 1e-4).asDiagonal();
      correction.after = Eigen::Vector2d(variance_, 1e-4).asDiagonal();
      lead_ -= gain * lead_;
      worst_ = std::max(worst_, std::abs(lead_));
      scale->learn(motionOf(length), correction, {map_is_complete, is_explained});
    }
  }

  double worstLag() const { return worst_; }

 private:
  double noise_;
  double measured_;
  double lead_ = 0.0;  ///< m, of the estimate along the course
  double variance_ = 1e-4;
  double worst_ = 0.0;
};

TEST(DistanceScale, IsKnownAfterTheFirstMetres) {
  for (const double measured : {0.8, 0.9, 1.25}) {
    for (const double direction : {1.0, -1.0}) {
      DistanceScale scale(100.0);
      Course course(0.1, measured);
      course.drive(12.0 * direction, &scale);
      EXPECT_NEAR(scale.scale(), 1.0 / measured, 0.03) << measured;
      EXPECT_LT(course.worstLag(), 0.25) << measured;
    }
  }
}

TEST(DistanceScale, TheLagIsLargerWithoutTheFilter) {
  DistanceScale filtered(100.0), averaged(100.0);
  averaged.resume(1.0, 15.0);
  Course with(0.3, 0.8), without(0.3, 0.8);
  with.drive(14.0, &filtered);
  without.drive(14.0, &averaged);
  EXPECT_LT(with.worstLag(), 0.5 * without.worstLag());
}

TEST(DistanceScale, AddsNoiseInTheFirstMetresOnACompleteMapOnly) {
  DistanceScale scale(100.0);
  Course course(0.05, 1.0);
  EXPECT_EQ(scale.varianceAlong(kStep), 0.0) << "before the first scan";
  course.drive(0.15, &scale);
  const double first = scale.varianceAlong(kStep);
  EXPECT_GT(first, 1e-5);
  course.drive(10.0, &scale);
  EXPECT_LT(scale.varianceAlong(kStep), 0.5 * first);
  EXPECT_GT(scale.varianceAlong(kStep), 0.0);
  DistanceScale incomplete = scale, obstructed = scale;
  course.drive(5.0, &scale);
  EXPECT_EQ(scale.varianceAlong(kStep), 0.0) << "15 m";
  course.drive(0.15, &incomplete, false);
  EXPECT_EQ(incomplete.varianceAlong(kStep), 0.0);
  course.drive(0.15, &obstructed, true, false);
  EXPECT_EQ(obstructed.varianceAlong(kStep), 0.0);
}

TEST(DistanceScale, ACorrectionAcrossTheWayThatItHasCausedCounts) {
  // Half a metre straight on without information, then a quarter turn: the scan now measures where
  // the car is across.
  DistanceScale scale(100.0);
  PoseCorrection blind;
  blind.before = blind.after = 0.01 * Eigen::Matrix2d::Identity();
  for (int scan = 0; scan < 6; ++scan) scale.learn(motionOf(kStep), blind, {true, true});
  scale.learn(motionOf(kStep, kPi / 2.0), blind, {true, true});
  PoseCorrection across = blind;
  across.pose = {0.0, -0.03, 0.0};
  across.after(1, 1) = 0.001;
  DistanceScale straight = scale;
  scale.learn(motionOf(kStep), across, {true, true});
  EXPECT_GT(scale.scale(), 1.001) << "the car was ahead, to the right of its estimate";
  straight.restart();
  straight.learn(motionOf(kStep), across, {true, true});
  EXPECT_EQ(straight.scale(), 1.0);
}

TEST(DistanceScale, LaterCorrectionsCountLess) {
  DistanceScale scale(100.0);
  Course(0.1, 1.0).drive(100.0, &scale);
  Course(0.1, 0.8).drive(5.0, &scale);
  EXPECT_LT(scale.scale(), 1.05);
}

TEST(DistanceScale, StaysFiniteAndWithinItsLimits) {
  DistanceScale scale(100.0);
  PoseCorrection singular;
  singular.pose = {1e3, 1e3, 0.0};
  for (int scan = 0; scan < 100; ++scan) scale.learn(motionOf(kStep), singular, {true, true});
  EXPECT_NEAR(scale.scale(), 1.0, 0.01);
  singular.before = Eigen::Matrix2d::Identity() * 1e-6;
  for (int scan = 0; scan < 1000; ++scan) scale.learn(motionOf(kStep), singular, {true, true});
  EXPECT_LE(scale.scale(), 1.35);
  EXPECT_TRUE(std::isfinite(scale.varianceAlong(kStep)));
}

}  // namespace
}  // namespace racecar_mcl
