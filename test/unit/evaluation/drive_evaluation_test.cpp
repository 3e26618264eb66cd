#include "evaluation/drive_evaluation.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

Observation observation(double error, LocalizationState state = LocalizationState::kLocalized,
                        double inlier_ratio_from_truth = 1.0) {
  Observation observation;
  observation.error = error;
  observation.inlier_ratio_from_truth = inlier_ratio_from_truth;
  observation.result.status.state = state;
  return observation;
}

TEST(LongestInterval, IsMeasuredFromThePreviousUpdate) {
  LongestInterval interval;
  interval.update(1.0, false);
  interval.update(2.0, true);
  interval.update(3.0, false);
  interval.update(4.0, true);
  interval.update(5.5, true);
  interval.update(6.0, false);
  EXPECT_EQ(interval.longest(), 2.5);
}

TEST(PositionErrors, AreSummedUp) {
  PositionErrors errors;
  EXPECT_EQ(errors.mean(), 0.0);
  EXPECT_EQ(errors.max(), 0.0);
  for (int i = 200; i > 0; --i) errors.add(0.01 * i);
  EXPECT_NEAR(errors.mean(), 1.005, 1e-12);
  EXPECT_NEAR(errors.quantile(0.99), 1.98, 1e-12);
  EXPECT_NEAR(errors.quantile(0.0), 0.01, 1e-12);
  EXPECT_NEAR(errors.max(), 2.0, 1e-12);
  EXPECT_NEAR(errors.fractionAbove(0.5), 0.75, 1e-12);
  PositionErrors more;
  more.add(5.0);
  more.add(errors);
  EXPECT_EQ(more.count(), 201U);
  EXPECT_EQ(more.max(), 5.0);
}

TEST(DriveEvaluation, CountsErrorsSinceTheFault) {
  DriveEvaluation evaluation;
  evaluation.update(-1.0, observation(9.0));
  evaluation.update(0.0, observation(0.1));
  evaluation.update(1.0, observation(0.3));
  EXPECT_EQ(evaluation.errors.count(), 2U);
  EXPECT_NEAR(evaluation.errors.mean(), 0.2, 1e-12);
  EXPECT_EQ(evaluation.scans, 3);
}

TEST(DriveEvaluation, SeparatesErrorsWhereTheMapIsComplete) {
  DriveEvaluation evaluation;
  evaluation.update(1.0, observation(0.1, LocalizationState::kLocalized, 0.6));
  evaluation.update(2.0, observation(0.5, LocalizationState::kLocalized, 0.59));
  EXPECT_EQ(evaluation.errors_where_mapped.count(), 1U);
  EXPECT_EQ(evaluation.errors_where_mapped.max(), 0.1);
}

TEST(DriveEvaluation, MeasuresLostWhileCorrect) {
  DriveEvaluation evaluation;
  evaluation.update(1.0, observation(0.1));
  evaluation.update(2.0, observation(0.1, LocalizationState::kLost));
  evaluation.update(3.0, observation(0.4, LocalizationState::kLost));
  evaluation.update(4.0, observation(0.6, LocalizationState::kLost));
  evaluation.update(5.0, observation(0.1, LocalizationState::kDegraded));
  EXPECT_EQ(evaluation.lost_while_correct.longest(), 2.0);
  EXPECT_EQ(evaluation.misleading.longest(), 0.0);
}

TEST(DriveEvaluation, MeasuresArrivalAndDetection) {
  DriveEvaluation evaluation;
  evaluation.update(0.5, observation(3.0));
  evaluation.update(1.0, observation(3.0, LocalizationState::kDegraded));
  evaluation.update(2.0, observation(0.1));
  evaluation.update(3.0, observation(0.6));
  evaluation.update(4.0, observation(0.1));
  EXPECT_EQ(evaluation.detected, 1.0);
  EXPECT_EQ(evaluation.arrived, 4.0);
  EXPECT_EQ(evaluation.misleading.longest(), 1.0);
}

TEST(SimulatedDrive, ReportsTheErrorOfThePredictionIfAScanIsNotUsed) {
  const LocalizerParameters parameters;
  const Course course = loadCourse(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml", parameters);
  const Pose2 start{-7.8, -2.65, 0.0};
  SimulatedDrive drive(course, parameters, {}, start, 3.0, 1);
  std::vector<Observation> observations;
  const auto keep = [&](const Observation& observation) { observations.push_back(observation); };
  drive.drive(0.1, keep);
  ASSERT_FALSE(observations.empty());
  EXPECT_EQ(observations.back().result.outcome, ScanOutcome::kNoStart);
  EXPECT_EQ(observations.back().error, HUGE_VAL);
  drive.localizer().initialize(
      {drive.simulator().truth().base_in_map, Eigen::Matrix3d::Identity() * 0.001});
  drive.drive(1.0, keep);
  drive.on_scan = [](Scan* scan) {
    *scan = takeBeams(*scan, {0, 1, 2});
    return true;
  };
  drive.drive(0.3, keep);
  EXPECT_EQ(observations.back().result.outcome, ScanOutcome::kTooFewBeams);
  EXPECT_LT(observations.back().error, 0.3);
}

TEST(SimulatedDrive, ComputesTheInlierRatioAtTheTruePose) {
  const LocalizerParameters parameters;
  const Course course = loadCourse(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml", parameters);
  const Pose2 start{-7.8, -2.65, 0.0};
  // A wrong start pose does not change it.
  SimulatedDrive drive(course, parameters, {}, start, 3.0, 1);
  PoseEstimate elsewhere{{5.0, -2.65, 0.0}, Eigen::Matrix3d::Identity() * 0.01};
  drive.localizer().initialize(elsewhere);
  double least = 1.0;
  drive.drive(1.5, [&](const Observation& observation) {
    least = std::min(least, observation.inlier_ratio_from_truth);
  });
  EXPECT_GT(least, 0.9);

  // On a map with one occupied cell, far away, there are no inliers.
  const OccupancyGrid& map = course.map->grid;
  std::vector<std::int8_t> cells(map.cells().size(), OccupancyGrid::kFree);
  cells.front() = OccupancyGrid::kOccupied;
  const Course empty{course.world,
                     makeLocalizationMap(OccupancyGrid(map.geometry(), cells), parameters)};
  SimulatedDrive blind(empty, parameters, {}, start, 3.0, 1);
  blind.localizer().initialize(elsewhere);
  double most = 0.0;
  blind.drive(0.5, [&](const Observation& observation) {
    most = std::max(most, observation.inlier_ratio_from_truth);
  });
  EXPECT_EQ(most, 0.0);
}

}  // namespace
}  // namespace racecar_mcl
