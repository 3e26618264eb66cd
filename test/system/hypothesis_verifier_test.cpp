// Tests of a hypothesis against the current estimate, on the simulated corridor.
#include "racecar_mcl/relocalization/hypothesis_verifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "offline/simulated_drive.h"
#include "sim/map_faults.h"
#include "support/map_user.h"
#include "support/single_wall.h"

namespace racecar_mcl {
namespace {

using Decision = HypothesisVerifier::Decision;
using Purpose = HypothesisVerifier::Purpose;

Pose2 asItIs(const Pose2& truth) { return truth; }
Pose2 aside(const Pose2& truth) { return compose(truth, {1.5, 0.0, 0.0}); }
Pose2 pushed(const Pose2& truth) { return compose(truth, {0.1, 0.3, 0.1}); }
Pose2 turnedRound(const Pose2& truth) { return compose(truth, {0.0, 0.0, kPi}); }

class HypothesisVerifierTest : public ::testing::Test {
 protected:
  HypothesisVerifierTest() { simulator_.lidar.instant = true; }

  /// A drive from a random pose.
  SimulatedDrive driveFrom(std::uint64_t place) const {
    Random random(place);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    return SimulatedDrive(course_, parameters_, simulator_, pose, 3.0, 1);
  }

  /// Drives until a decision, for at most this time. `carried` is the current estimate.
  Decision decisionWithin(double seconds, Purpose purpose,
                          const std::function<Pose2(const Pose2& truth)>& carried,
                          std::uint64_t place = 1) {
    SimulatedDrive drive = driveFrom(place);
    MapUser map(course_.map, parameters_.sensor);
    Scan beams;
    drive.on_scan = [&](Scan* scan) {
      beams = ScanPreprocessor(parameters_.scan).select(*scan);
      return true;
    };
    Decision decision = Decision::kUndecided;
    std::optional<Observation> before;
    drive.drive(seconds, [&](const Observation& now) {
      if (decision != Decision::kUndecided && decision != unheeded_) return;
      if (!verifier_.confirming() && !verifier_.challenging()) {
        verifier_.start(purpose, map.searchMap(), beams, carried_is_confirmed_);
      } else if (before) {
        Motion motion;
        motion.delta = between(before->base_in_map, now.base_in_map);
        motion.distance = std::hypot(motion.delta.x, motion.delta.y);
        motion.rotation = std::abs(motion.delta.yaw);
        motion.seconds = now.result.stamp - before->result.stamp;
        PoseEstimate estimate;
        estimate.base_in_map = carried(now.base_in_map);
        estimate.covariance = Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal();
        decision = verifier_.update(motion, map.searchMap(), beams, estimate);
        travelled_ += motion.distance;
      }
      before = now;
      truth_ = now.base_in_map;
    });
    return decision;
  }

  /// Distance from the truth, m.
  double errorOfParticles() const {
    const PoseEstimate found = estimatePose(verifier_.particles(), EstimateFrom::kMean);
    return distance(found.base_in_map, truth_);
  }

  LocalizerParameters parameters_;
  sim::SimulatorParameters simulator_;
  Course course_ = loadCourse(RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml", parameters_);
  HypothesisVerifier verifier_{parameters_.filter, parameters_.motion, 1};
  bool carried_is_confirmed_ = true;
  Decision unheeded_ = Decision::kUndecided;  ///< does not end the drive
  Pose2 truth_;                               ///< at the last scan
  double travelled_ = 0.0;                    ///< m, until something was decided
};

TEST_F(HypothesisVerifierTest, KnowsWhatItSearchesFor) {
  EXPECT_FALSE(verifier_.confirming());
  EXPECT_FALSE(verifier_.challenging());
  Scan scan;
  scan.bearings = scan.ranges = scan.seconds_after_stamp = Eigen::ArrayXf::Ones(10);
  MapUser map(course_.map, parameters_.sensor);
  verifier_.start(Purpose::kConfirm, map.searchMap(), scan);
  EXPECT_TRUE(verifier_.confirming());
  EXPECT_FALSE(verifier_.challenging());
  verifier_.start(Purpose::kChallenge, map.searchMap(), scan);
  EXPECT_FALSE(verifier_.confirming());
  EXPECT_TRUE(verifier_.challenging());
  EXPECT_FALSE(verifier_.candidate());
  verifier_.stop();
  EXPECT_FALSE(verifier_.confirming());
  EXPECT_FALSE(verifier_.challenging());
}

TEST_F(HypothesisVerifierTest, ConfirmsTheRightPlace) {
  EXPECT_EQ(decisionWithin(5.0, Purpose::kConfirm, asItIs), Decision::kConfirmed);
  EXPECT_FALSE(verifier_.confirming());
}

TEST_F(HypothesisVerifierTest, ObjectsToAPlaceThatExplainsTheScansFarWorse) {
  EXPECT_EQ(decisionWithin(5.0, Purpose::kConfirm, aside), Decision::kProven);
  EXPECT_LT(errorOfParticles(), 0.2);
  ASSERT_TRUE(verifier_.candidate());
  EXPECT_LT(distance(verifier_.candidate()->base_in_map, truth_), 0.2);
}

TEST_F(HypothesisVerifierTest, ObjectsToTheRightPlaceTurnedRound) {
  EXPECT_EQ(decisionWithin(5.0, Purpose::kConfirm, turnedRound), Decision::kProven);
}

TEST_F(HypothesisVerifierTest, BeginsAgainToConfirmWhereItIsWrong) {
  // The estimate is at one place, the car at another.
  ASSERT_EQ(decisionWithin(5.0, Purpose::kConfirm, turnedRound, 2), Decision::kProven);
  unheeded_ = Decision::kProven;
  EXPECT_EQ(decisionWithin(5.0, Purpose::kConfirm, asItIs, 3), Decision::kConfirmed);
}

TEST_F(HypothesisVerifierTest, AChallengeOfTheRightPlaceComesToNothing) {
  for (std::uint64_t place = 1; place <= 3; ++place) {
    const Decision decision = decisionWithin(8.0, Purpose::kChallenge, asItIs, place);
    EXPECT_TRUE(decision == Decision::kConfirmed || decision == Decision::kRejected) << place;
    EXPECT_FALSE(verifier_.challenging());
  }
}

TEST_F(HypothesisVerifierTest, AChallengeOfTheRightPlaceComesToNothingWhereTheMapLacksAWing) {
  Random random(3);
  course_.map = makeLocalizationMap(sim::eraseWing(course_.map->grid, 0.35, random), parameters_);
  for (std::uint64_t place = 1; place <= 5; ++place) {
    EXPECT_NE(decisionWithin(8.0, Purpose::kChallenge, asItIs, place), Decision::kProven) << place;
    verifier_.stop();
  }
}

TEST_F(HypothesisVerifierTest, AChallengeOfAWrongPlaceIsProvenAndParticlesStandAtTheTruth) {
  for (std::uint64_t place = 1; place <= 3; ++place) {
    EXPECT_EQ(decisionWithin(8.0, Purpose::kChallenge, turnedRound, place), Decision::kProven)
        << place;
    EXPECT_LT(errorOfParticles(), 0.2) << place;
    EXPECT_TRUE(verifier_.challenging()) << "the caller stops it after taking the particles";
    verifier_.stop();
  }
}

TEST_F(HypothesisVerifierTest, AChallengeMovesThePoseWithinItsPlace) {
  for (std::uint64_t place = 1; place <= 3; ++place) {
    EXPECT_EQ(decisionWithin(8.0, Purpose::kChallenge, pushed, place), Decision::kProven) << place;
    EXPECT_LT(errorOfParticles(), 0.1) << place;
    verifier_.stop();
  }
  EXPECT_EQ(decisionWithin(8.0, Purpose::kConfirm, pushed), Decision::kConfirmed)
      << "both are the same place";
}

TEST_F(HypothesisVerifierTest, APoseThatWasNeverConfirmedIsGivenUpSooner) {
  ASSERT_EQ(decisionWithin(8.0, Purpose::kChallenge, turnedRound), Decision::kProven);
  const double confirmed = travelled_;
  verifier_ = HypothesisVerifier(parameters_.filter, parameters_.motion, 1);
  travelled_ = 0.0;
  carried_is_confirmed_ = false;
  ASSERT_EQ(decisionWithin(8.0, Purpose::kChallenge, turnedRound), Decision::kProven);
  EXPECT_LT(travelled_, confirmed);
}

TEST_F(HypothesisVerifierTest, APoseThatWasCarriedThroughAWallIsGivenUp) {
  int scans = 0;
  // Beams that end outside the map contradict the pose only because it cannot be there.
  const auto outside = [&](const Pose2& truth) {
    return ++scans < 3 ? truth : Pose2{truth.x, truth.y - 60.0, truth.yaw};
  };
  EXPECT_EQ(decisionWithin(8.0, Purpose::kChallenge, outside), Decision::kProven);
  EXPECT_LT(errorOfParticles(), 0.2);
}

/// 65 beams (ten independent ones) towards a wall 3.5 m ahead.
class ContradictionLogOdds : public WallAhead {
 protected:
  double of(const Pose2& candidate, const Pose2& carried, bool unmapped_counts = false) {
    return contradictionLogOdds(map_with_unknown_->view(), candidate, carried, scan_,
                                unmapped_counts);
  }

  std::shared_ptr<const LocalizationMap> map_with_unknown_ =
      makeLocalizationMap(asciiMap(R"(
      ??????##############
      ??????.....#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      ####################)"),
                          SensorParameters{});
  const Scan scan_ = beamsAhead(65, 3.5f);
  const Pose2 matched_{8.0, 2.5, 0.0};
  const Pose2 short_{4.0, 2.5, 0.0};
  const Pose2 through_{9.5, 2.5, 0.0};
  const Pose2 unmapped_{2.5, 1.4, kPi / 2.0};
};

TEST_F(ContradictionLogOdds, OfAPlaceAgainstItselfAreZero) {
  for (const Pose2& pose : {matched_, short_, through_}) EXPECT_EQ(of(pose, pose), 0.0);
}

TEST_F(ContradictionLogOdds, SpeakForTheCandidateWhereTheMapContradictsTheCarriedPose) {
  EXPECT_NEAR(of(matched_, short_), 10.0, 1e-3);
  EXPECT_NEAR(of(matched_, through_), 20.0, 1e-3);
}

TEST_F(ContradictionLogOdds, SpeakAgainstTheCandidateThatTheMapContradicts) {
  EXPECT_NEAR(of(short_, matched_), -10.0, 1e-3);
  EXPECT_NEAR(of(through_, matched_), -20.0, 1e-3);
  EXPECT_NEAR(of(short_, through_), 10.0, 1e-3);
}

TEST_F(ContradictionLogOdds, TakeUnmappedBeamsForNeutralOfTheCarriedPose) {
  EXPECT_NEAR(of(matched_, unmapped_), 0.0, 1e-3);
  EXPECT_NEAR(of(short_, unmapped_), -10.0, 1e-3);
  EXPECT_NEAR(of(matched_, unmapped_, true), 10.0, 1e-3) << "unless the pose is impossible";
}

TEST_F(ContradictionLogOdds, TakeUnmappedBeamsForUnexplainedByTheCandidate) {
  EXPECT_NEAR(of(unmapped_, matched_), -10.0, 1e-3);
  EXPECT_NEAR(of(unmapped_, unmapped_), -10.0, 1e-3);
  EXPECT_NEAR(of(unmapped_, unmapped_, true), 0.0, 1e-3);
  EXPECT_NEAR(of(unmapped_, through_), 10.0, 1e-3);
}

}  // namespace
}  // namespace racecar_mcl
