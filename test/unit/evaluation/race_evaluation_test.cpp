#include "evaluation/race_evaluation.h"

#include <gtest/gtest.h>

#include "support/analytic_room.h"

namespace racecar_mcl {
namespace {

TEST(LapTimer, TimesLapsAfterTheFirst) {
  LapTimer timer(10.0);
  auto drive = [&, driven = 0.0, time = 100.0](double speed, double seconds) mutable {
    for (double end = time + seconds; time < end - 1e-9; time += 0.02) {
      timer.update(driven - std::floor(driven / 10.0) * 10.0, time);
      driven += 0.02 * speed;
    }
  };
  drive(1.0, 5.0);
  drive(2.0, 2.5);  // to the finish line
  EXPECT_TRUE(timer.lapTimes().empty());
  drive(5.0, 2.0);
  drive(4.0, 2.6);
  EXPECT_EQ(timer.laps(), 3);
  ASSERT_EQ(timer.lapTimes().size(), 2U);
  EXPECT_NEAR(timer.lapTimes()[0], 2.0, 1e-6);
  EXPECT_NEAR(timer.lapTimes()[1], 2.5, 1e-6);
}

TEST(LapTimer, CountsNoLapForAStartBehindTheLine) {
  LapTimer timer(10.0);
  timer.update(9.9, 1.0);
  timer.update(0.1, 1.1);
  EXPECT_EQ(timer.laps(), 0);
  EXPECT_TRUE(timer.lapTimes().empty());
}

TEST(RaceScore, SummarizesLapTimes) {
  RaceScore score;
  EXPECT_EQ(score.meanLapTime(), 0.0);
  EXPECT_EQ(score.lapTimeDeviation(), 0.0);
  EXPECT_EQ(score.shareAtBounds(), 0.0);
  score.lap_times = {10.0};
  RaceScore other;
  other.lap_times = {12.0};
  other.collisions = 2;
  other.max_speed = 7.0;
  score += other;
  EXPECT_NEAR(score.meanLapTime(), 11.0, 1e-12);
  EXPECT_NEAR(score.lapTimeDeviation(), 1.0, 1e-12);
  EXPECT_EQ(score.collisions, 2);
  EXPECT_EQ(score.max_speed, 7.0);
}

TEST(RaceScore, HasTheErrorsInTheFrameOfTheCar) {
  RaceScore score;
  EXPECT_EQ(score.shareLocalized(), 0.0);
  EXPECT_EQ(score.shareBeyondLevel(), 0.0);
  const Pose2 truth{1.0, 2.0, kPi / 2.0};
  score.addEstimate({1.0, 2.1, 0.0}, truth);
  score.addEstimate({1.02, 2.0, 0.0}, truth);
  EXPECT_NEAR(score.along.max(), 0.1, 1e-12);
  EXPECT_NEAR(score.across.max(), 0.02, 1e-12);
}

TEST(RaceScore, CountsErrorsBeyondTheLevelWhileLocalized) {
  RaceScore score;
  LocalizationStatus status;
  status.level = {0.2, 0.05, 0.1};
  const auto add = [&](LocalizationState state, const Pose2& estimate) {
    status.state = state;
    score.addStatus(status, estimate, {});
  };
  add(LocalizationState::kLocalized, {0.19, 0.04, 0.09});
  add(LocalizationState::kLocalized, {0.21, 0.0, 0.0});
  add(LocalizationState::kLocalized, {0.0, -0.06, 0.0});
  add(LocalizationState::kLocalized, {0.0, 0.0, -0.11});
  add(LocalizationState::kDegraded, {1.0, 0.0, 0.0});
  RaceScore sum;
  sum += score;
  EXPECT_NEAR(sum.shareLocalized(), 0.8, 1e-12);
  EXPECT_NEAR(sum.shareBeyondLevel(), 0.75, 1e-12);
}

TEST(BoundsMatch, FallsWithTheErrorOfThePose) {
  const Room room;
  const BoundsMatch bounds(room.grid());
  Scan scan;
  scan.bearings = Eigen::ArrayXf::LinSpaced(200, -2.0F, 2.0F);
  scan.ranges = scan.bearings;
  const Pose2 pose{3.0, 2.0, 0.4};
  for (Eigen::Index k = 0; k < scan.size(); ++k) {
    scan.ranges[k] = static_cast<float>(room.range(pose, static_cast<double>(scan.bearings[k])));
  }
  const auto none = [](const Eigen::Vector2d&) { return false; };
  RaceScore right;
  bounds.add(scan, pose, none, &right);
  EXPECT_EQ(right.returns, 200);
  EXPECT_EQ(right.returns_at_bounds, 200);

  // By 0.3 m along x: only the returns of the walls along x stay at the bounds.
  RaceScore wrong;
  bounds.add(scan, {3.3, 2.0, 0.4}, none, &wrong);
  EXPECT_LT(wrong.shareAtBounds(), 0.8);
  EXPECT_GT(wrong.shareAtBounds(), 0.2);

  RaceScore rest;
  bounds.add(
      scan, pose, [](const Eigen::Vector2d& point) { return point.x() > 7.0; }, &rest);
  EXPECT_LT(rest.returns, 180);
  EXPECT_GT(rest.returns, 0);
}

}  // namespace
}  // namespace racecar_mcl
