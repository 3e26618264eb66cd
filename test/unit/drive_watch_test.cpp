#include "evaluation/drive_watch.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

Observation seen(double error, VerdictState state = VerdictState::kLocalized,
                 double explained_from_truth = 1.0) {
  Observation observation;
  observation.error = error;
  observation.explained_from_truth = explained_from_truth;
  observation.result.verdict.state = state;
  return observation;
}

TEST(LongestSpell, IsTheLongestStretchSinceTheTimeBefore) {
  LongestSpell spell;
  spell.see(1.0, false);
  spell.see(2.0, true);
  spell.see(3.0, false);
  spell.see(4.0, true);
  spell.see(5.5, true);
  spell.see(6.0, false);
  EXPECT_EQ(spell.longest(), 2.5);
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
  EXPECT_NEAR(errors.shareAbove(0.5), 0.75, 1e-12);
  PositionErrors more;
  more.add(5.0);
  more.add(errors);
  EXPECT_EQ(more.count(), 201U);
  EXPECT_EQ(more.max(), 5.0);
}

TEST(DriveWatch, CountsErrorsSinceTheTroubleBegan) {
  DriveWatch watch;
  watch.see(-1.0, seen(9.0));
  watch.see(0.0, seen(0.1));
  watch.see(1.0, seen(0.3));
  EXPECT_EQ(watch.errors.count(), 2U);
  EXPECT_NEAR(watch.errors.mean(), 0.2, 1e-12);
  EXPECT_EQ(watch.scans, 3);
}

TEST(DriveWatch, PartsTheErrorsWhereTheMapShowsWhatTheLidarSees) {
  DriveWatch watch;
  watch.see(1.0, seen(0.1, VerdictState::kLocalized, 0.6));
  watch.see(2.0, seen(0.5, VerdictState::kLocalized, 0.59));
  EXPECT_EQ(watch.errors_where_mapped.count(), 1U);
  EXPECT_EQ(watch.errors_where_mapped.max(), 0.1);
}

TEST(DriveWatch, TellsHowLongLostWasSaidWhileRight) {
  DriveWatch watch;
  watch.see(1.0, seen(0.1));
  watch.see(2.0, seen(0.1, VerdictState::kLost));
  watch.see(3.0, seen(0.4, VerdictState::kLost));
  watch.see(4.0, seen(0.6, VerdictState::kLost));
  watch.see(5.0, seen(0.1, VerdictState::kDegraded));
  EXPECT_EQ(watch.lost_while_right.longest(), 2.0);
  EXPECT_EQ(watch.wrongly_trusted.longest(), 0.0);
}

TEST(DriveWatch, TellsWhenItArrivedAndWhenItWasNoticed) {
  DriveWatch watch;
  watch.see(0.5, seen(3.0));
  watch.see(1.0, seen(3.0, VerdictState::kDegraded));
  watch.see(2.0, seen(0.1));
  watch.see(3.0, seen(0.6));
  watch.see(4.0, seen(0.1));
  EXPECT_EQ(watch.noticed, 1.0);
  EXPECT_EQ(watch.arrived, 4.0);
  EXPECT_EQ(watch.wrongly_trusted.longest(), 1.0);
}

TEST(SimulatedDrive, TellsTheErrorOfTheCarriedEstimateWhereAScanIsNotUsed) {
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

TEST(SimulatedDrive, SeesWhatTheMapExplainsFromWhereTheCarTrulyIs) {
  const LocalizerParameters parameters;
  const Course course = loadCourse(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml", parameters);
  const Pose2 start{-7.8, -2.65, 0.0};
  // The localizer is told a wrong place: that changes nothing.
  SimulatedDrive drive(course, parameters, {}, start, 3.0, 1);
  PoseEstimate elsewhere{{5.0, -2.65, 0.0}, Eigen::Matrix3d::Identity() * 0.01};
  drive.localizer().initialize(elsewhere);
  double least = 1.0;
  drive.drive(1.5, [&](const Observation& observation) {
    least = std::min(least, observation.explained_from_truth);
  });
  EXPECT_GT(least, 0.9);

  // An empty map explains nothing.
  const OccupancyGrid& map = course.map->grid;
  const Course empty{
      course.world,
      makeMapModel(OccupancyGrid(map.geometry(), std::vector<std::int8_t>(map.cells().size(), 0)),
                   parameters)};
  SimulatedDrive blind(empty, parameters, {}, start, 3.0, 1);
  blind.localizer().initialize(elsewhere);
  double most = 0.0;
  blind.drive(0.5, [&](const Observation& observation) {
    most = std::max(most, observation.explained_from_truth);
  });
  EXPECT_EQ(most, 0.0);
}

}  // namespace
}  // namespace racecar_mcl
