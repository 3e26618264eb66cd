// Whether a second search agrees with a first one, on the simulated corridor.
#include "racecar_mcl/second_opinion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "evaluation/simulated_drive.h"

namespace racecar_mcl {
namespace {

using Answer = SecondOpinion::Answer;

class SecondOpinionTest : public ::testing::Test {
 protected:
  SecondOpinionTest() { simulator_.lidar.instant = true; }

  /// A drive from one of many places.
  SimulatedDrive driveFrom(std::uint64_t place) const {
    Random random(place);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    return SimulatedDrive(course_, parameters_, simulator_, pose, 3.0, 1);
  }

  Scan firstScanFrom(std::uint64_t place) const {
    SimulatedDrive drive = driveFrom(place);
    std::optional<Scan> first;
    drive.on_scan = [&](Scan* scan) {
      if (!first) first = chooseBeams(parameters_, *scan);
      return true;
    };
    drive.drive(0.2, [](const Observation&) {});
    return *first;
  }

  /// Drives for so long at most, until the second search has said something. `first` is where the
  /// first one has the car.
  Answer answerWithin(double seconds, const std::function<Pose2(const Pose2& truth)>& first) {
    SimulatedDrive drive = driveFrom(1);
    Scan beams;
    drive.on_scan = [&](Scan* scan) {
      beams = chooseBeams(parameters_, *scan);
      return true;
    };
    Answer answer = Answer::kNotYet;
    std::optional<Observation> before;
    drive.drive(seconds, [&](const Observation& now) {
      if (answer != Answer::kNotYet) return;
      if (!second_.pending()) {
        second_.ask(*course_.map, beams);
      } else if (before) {
        Motion motion;
        motion.delta = between(before->base_in_map, now.base_in_map);
        motion.distance = std::hypot(motion.delta.x, motion.delta.y);
        motion.rotation = std::abs(motion.delta.yaw);
        motion.seconds = now.result.stamp - before->result.stamp;
        answer = second_.hear(motion, course_.map.get(), beams, first(now.base_in_map));
      }
      before = now;
      truth_ = now.base_in_map;
    });
    return answer;
  }

  LocalizerParameters parameters_;
  sim::SimulatorParameters simulator_;
  Course course_ = loadCourse(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml", parameters_);
  SecondOpinion second_{parameters_.filter, parameters_.motion, 1};
  Pose2 truth_;  ///< at the last scan
};

TEST_F(SecondOpinionTest, AgreesWithTheRightPlace) {
  EXPECT_EQ(answerWithin(5.0, [](const Pose2& truth) { return truth; }), Answer::kAgrees);
  EXPECT_FALSE(second_.pending());
}

TEST_F(SecondOpinionTest, ObjectsToAPlaceThatExplainsTheScansFarWorse) {
  const auto aside = [](const Pose2& truth) { return compose(truth, {1.5, 0.0, 0.0}); };
  EXPECT_EQ(answerWithin(5.0, aside), Answer::kObjects);
  const PoseEstimate found = estimatePose(second_.particles(), EstimateFrom::kMean);
  EXPECT_LT(distance(found.base_in_map, truth_), 0.2);
}

TEST_F(SecondOpinionTest, ObjectsToTheRightPlaceTurnedRound) {
  const auto turned = [](const Pose2& truth) { return compose(truth, {0.0, 0.0, kPi}); };
  EXPECT_EQ(answerWithin(5.0, turned), Answer::kObjects);
}

TEST_F(SecondOpinionTest, BeginsAgainWhereItWentWrong) {
  for (const std::uint64_t elsewhere : {2, 3, 4}) {
    second_.ask(*course_.map, firstScanFrom(elsewhere));
    EXPECT_EQ(answerWithin(8.0, [](const Pose2& truth) { return truth; }), Answer::kAgrees)
        << elsewhere;
  }
}

TEST_F(SecondOpinionTest, CanBeDropped) {
  second_.ask(*course_.map, firstScanFrom(1));
  EXPECT_TRUE(second_.pending());
  second_.drop();
  EXPECT_FALSE(second_.pending());
}

}  // namespace
}  // namespace racecar_mcl
