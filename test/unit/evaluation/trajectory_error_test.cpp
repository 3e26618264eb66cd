#include "evaluation/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

constexpr Nanoseconds kSecond = 1000000000;

StampedPose at(double seconds, const Pose2& pose) { return {std::llround(seconds * 1e9), pose}; }

TEST(Quantile, interpolatesBetweenRanksAsNumpyDoes) {
  const std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  EXPECT_DOUBLE_EQ(quantile(values, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile(values, 0.95), 3.85);
  EXPECT_DOUBLE_EQ(quantile(values, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.95), 7.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(PoseAt, interpolatesPositionStraightAndYawTheShortWayRound) {
  const Trajectory trajectory{at(1.0, {0.0, 0.0, kPi - 0.1}), at(2.0, {4.0, 2.0, -kPi + 0.3})};
  const Pose2 pose = poseAt(trajectory, kSecond + kSecond / 4, 1.0).value();
  EXPECT_NEAR(pose.x, 1.0, 1e-12);
  EXPECT_NEAR(pose.y, 0.5, 1e-12);
  EXPECT_NEAR(wrapAngle(pose.yaw - kPi), 0.0, 1e-12);
}

TEST(PoseAt, knowsNothingOutsideAndInsideGaps) {
  const Trajectory trajectory{at(1.0, {}), at(1.5, {}), at(3.0, {1.0, 0.0, 0.0})};
  EXPECT_FALSE(poseAt(trajectory, kSecond - 1, 0.5));
  EXPECT_FALSE(poseAt(trajectory, 3 * kSecond + 1, 0.5));
  EXPECT_TRUE(poseAt(trajectory, kSecond + 1, 0.5));
  EXPECT_FALSE(poseAt(trajectory, 2 * kSecond, 0.5));
  EXPECT_TRUE(poseAt(trajectory, 2 * kSecond, 1.5));
  EXPECT_TRUE(poseAt(trajectory, 3 * kSecond, 0.5)) << "a pose of that very stamp needs no gap";
}

TEST(CompareTrajectories, takesEveryTruthStampInsideTheRunAndSkipsThoseInGaps) {
  const Trajectory estimate{at(1.0, {1.0, 0.0, 0.0}), at(1.4, {1.4, 0.0, 0.1}),
                            at(3.0, {3.0, 0.0, 0.0}), at(3.2, {3.2, 0.0, -0.1})};
  const Trajectory truth{at(0.9, {}),
                         at(1.0, {1.0, 0.3, 0.0}),    // 0.3 m, 0 rad
                         at(1.2, {1.2, 0.0, -0.15}),  // 0 m, 0.2 rad
                         at(2.0, {}),                 // in the gap
                         at(3.2, {2.8, 0.3, 0.3}),    // 0.5 m, 0.4 rad
                         at(3.3, {})};
  const TrajectoryErrors errors = compareTrajectories(estimate, truth, 0.5);
  EXPECT_EQ(errors.stamps_used, 3);
  EXPECT_EQ(errors.stamps_skipped, 1);

  const PositionErrorSummary position = summarizePosition(errors);
  EXPECT_NEAR(position.mean, 0.8 / 3.0, 1e-12);
  EXPECT_NEAR(position.median, 0.3, 1e-12);
  EXPECT_NEAR(position.p95, 0.3 + 0.9 * 0.2, 1e-12);
  EXPECT_NEAR(position.max, 0.5, 1e-12);
  EXPECT_NEAR(position.rmse, std::sqrt(0.34 / 3.0), 1e-12);
  EXPECT_NEAR(position.final, 0.5, 1e-12);

  const HeadingErrorSummary heading = summarizeHeading(errors);
  EXPECT_NEAR(heading.mean, 0.2 * 180.0 / kPi, 1e-9);
  EXPECT_NEAR(heading.p95, (0.2 + 0.9 * 0.2) * 180.0 / kPi, 1e-9);
  EXPECT_NEAR(heading.max, 0.4 * 180.0 / kPi, 1e-9);
}

TEST(CompareTrajectories, measuresHeadingAcrossTheSeamOfTheCircle) {
  const Trajectory estimate{at(1.0, {0.0, 0.0, kPi - 0.1})};
  const Trajectory truth{at(1.0, {0.0, 0.0, -kPi + 0.1})};
  EXPECT_NEAR(compareTrajectories(estimate, truth, 0.5).heading.at(0), 0.2, 1e-12);
}

TEST(CompareTrajectories, withoutEstimatesUsesNothing) {
  const TrajectoryErrors errors = compareTrajectories({}, {at(1.0, {})}, 0.5);
  EXPECT_EQ(errors.stamps_used + errors.stamps_skipped, 0);
}

TEST(Tum, keepsStampsToTheNanosecond) {
  const Trajectory written{{1663967375801351234, {1.25, -2.5, 3.0}},
                           {1663967375801351235, {1.25, -2.5, -3.0}}};
  const TemporaryDirectory folder;
  std::ostringstream text;
  writeTum(written, text);
  const Trajectory read = readTum(folder.write("t.tum", text.str()));
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].stamp, written[i].stamp);
    EXPECT_NEAR(read[i].pose.x, written[i].pose.x, 1e-9);
    EXPECT_NEAR(read[i].pose.y, written[i].pose.y, 1e-9);
    EXPECT_NEAR(read[i].pose.yaw, written[i].pose.yaw, 1e-9);
  }
}

TEST(Tum, readsCommentsShortFractionsExponentsAndAnyOrder) {
  const TemporaryDirectory folder;
  const Trajectory read = readTum(folder.write("t.tum",
                                               "# t x y z qx qy qz qw\n\n"
                                               "12.5 1 2 0 0 0 0 2\r\n"
                                               "1.2e1 3 4 0 0 0 1 0\n"
                                               "13 5 6 0 0 0 0 1\n"
                                               "13.000000000 7 8 0 0 0 0 1\n"));
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].stamp, 12 * kSecond);
  EXPECT_NEAR(read[0].pose.yaw, kPi, 1e-9);
  EXPECT_EQ(read[1].stamp, 12 * kSecond + kSecond / 2);
  EXPECT_NEAR(read[1].pose.yaw, 0.0, 1e-9);
  EXPECT_EQ(read[2].pose.x, 5.0);
}

TEST(Tum, refusesWhatIsNoPoseAndSaysWhere) {
  const TemporaryDirectory folder;
  for (const char* line :
       {"1.0 2 3", "x 1 2 0 0 0 0 1", "1.0.0 1 2 0 0 0 0 1", "1 nan 2 0 0 0 0 1", "1 1 2 0 0 0 0 0",
        "99999999999999 1 2 0 0 0 0 1", "nan 1 2 0 0 0 0 1"}) {
    const std::string path = folder.write("t.tum", std::string("0 0 0 0 0 0 0 1\n") + line + "\n");
    try {
      readTum(path);
      ADD_FAILURE() << line;
    } catch (const TrajectoryError& error) {
      EXPECT_NE(std::string(error.what()).find(path + ", line 2"), std::string::npos)
          << error.what();
    }
  }
  EXPECT_THROW(readTum(folder.write("empty.tum", "# nothing\n")), TrajectoryError);
  EXPECT_THROW(readTum((folder.path() / "none.tum").string()), TrajectoryError);
}

}  // namespace
}  // namespace racecar_mcl
