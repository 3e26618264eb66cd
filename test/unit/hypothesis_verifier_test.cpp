// Whether a second search agrees with a first one, on the simulated corridor.
#include "racecar_mcl/hypothesis_verifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "evaluation/simulated_drive.h"

namespace racecar_mcl {
namespace {

using Answer = SecondOpinion::Answer;

Pose2 turnedRound(const Pose2& truth) { return compose(truth, {0.0, 0.0, kPi}); }

class SecondOpinionTest : public ::testing::Test {
 protected:
  SecondOpinionTest() { simulator_.lidar.instant = true; }

  /// A drive from one of many places.
  SimulatedDrive driveFrom(std::uint64_t place) const {
    Random random(place);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    return SimulatedDrive(course_, parameters_, simulator_, pose, 3.0, 1);
  }

  /// Drives for so long at most, until the second search has said something. `first` is where the
  /// first one has the car.
  Answer answerWithin(double seconds, const std::function<Pose2(const Pose2& truth)>& first,
                      std::uint64_t place = 1) {
    SimulatedDrive drive = driveFrom(place);
    Scan beams;
    drive.on_scan = [&](Scan* scan) {
      beams = chooseBeams(parameters_, *scan);
      return true;
    };
    Answer answer = Answer::kNotYet;
    std::optional<Observation> before;
    drive.drive(seconds, [&](const Observation& now) {
      if (answer != Answer::kNotYet && answer != unheeded_) return;
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
  Answer unheeded_ = Answer::kNotYet;  ///< does not end the drive
  Pose2 truth_;                        ///< at the last scan
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
  EXPECT_EQ(answerWithin(5.0, turnedRound), Answer::kObjects);
}

TEST_F(SecondOpinionTest, BeginsAgainWhereItIsWrong) {
  // It settles in one place, and the car is in another.
  ASSERT_EQ(answerWithin(5.0, turnedRound, 2), Answer::kObjects);
  unheeded_ = Answer::kObjects;
  EXPECT_EQ(answerWithin(
                5.0, [](const Pose2& truth) { return truth; }, 3),
            Answer::kAgrees);
}

}  // namespace
}  // namespace racecar_mcl
