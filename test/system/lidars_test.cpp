// A simulated car with lidars of 180 degrees in front and at the rear.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "offline/simulated_drive.h"

namespace racecar_mcl {
namespace {

class FrontAndRearLidarTest : public ::testing::TestWithParam<const char*> {
 protected:
  struct Errors {
    double sum = 0.0;  ///< m
    int scans = 0;
    int within_3_sigma[3] = {0, 0, 0};  ///< of x, y and yaw

    void add(const Observation& seen) {
      const PoseEstimate& estimate = seen.result.update.estimate;
      sum += seen.error;
      ++scans;
      const double errors[] = {estimate.base_in_map.x - seen.base_in_map.x,
                               estimate.base_in_map.y - seen.base_in_map.y,
                               wrapAngle(estimate.base_in_map.yaw - seen.base_in_map.yaw)};
      for (int axis = 0; axis < 3; ++axis) {
        const double sigma = std::sqrt(estimate.covariance(axis, axis));
        within_3_sigma[axis] += std::abs(errors[axis]) <= 3.0 * sigma;
      }
    }
  };

  FrontAndRearLidarTest() {
    simulator_.lidar.field_of_view = kPi;
    simulator_.lidar.rate = 20.0;
    simulator_.lidar.sweep_time = 0.5 / simulator_.lidar.rate;
    simulator_.lidar.beams = 721;
    simulator_.rear_lidar.enabled = true;
  }

  SimulatedDrive start() const {
    Random random(5);
    const Pose2 start = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive drive(course_, parameters_, simulator_, start, 3.0, 5);
    drive.localizer().initialize({start, Eigen::Matrix3d::Zero()});
    return drive;
  }

  /// Over 20 s after 8 s, in which bias and direction are learned.
  static void expectAccurateAndConsistent(SimulatedDrive* drive) {
    drive->drive(8.0, [](const Observation&) {});
    Errors errors;
    drive->drive(20.0, [&](const Observation& seen) {
      ASSERT_TRUE(hasEstimate(seen.result.outcome)) << toString(seen.result.outcome);
      errors.add(seen);
    });
    EXPECT_GT(errors.scans, 790) << "scans of both lidars are used";
    EXPECT_LT(errors.sum / errors.scans, 0.015);
    for (const int within : errors.within_3_sigma) {
      EXPECT_GT(static_cast<double>(within) / errors.scans, 0.97);
    }
  }

  LocalizerParameters parameters_;
  sim::SimulatorParameters simulator_;
  Course course_ =
      loadCourse(std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml", parameters_);
};

/// The turns of the corridor are tight enough to distort a sweep.
class CorridorLidarTest : public FrontAndRearLidarTest {};

TEST_P(FrontAndRearLidarTest, IsAccurateAndConsistentThoughOneIsBiased) {
  simulator_.rear_lidar.range_bias = 0.03;
  SimulatedDrive drive = start();
  expectAccurateAndConsistent(&drive);
  const std::vector<LidarState>& lidars = drive.localizer().lidars();
  ASSERT_EQ(lidars.size(), 2u);
  EXPECT_NEAR(lidars[1].range_bias.bias() - lidars[0].range_bias.bias(), 0.03, 0.005);
}

TEST_P(CorridorLidarTest, IsAccurateAndConsistentThoughOneIsBiasedAndClockwise) {
  simulator_.rear_lidar.range_bias = 0.03;
  simulator_.rear_lidar.clockwise = true;
  SimulatedDrive drive = start();
  expectAccurateAndConsistent(&drive);
  const std::vector<LidarState>& lidars = drive.localizer().lidars();
  EXPECT_FALSE(lidars.at(0).direction.isReversed());
  EXPECT_TRUE(lidars.at(1).direction.isReversed());
  EXPECT_NEAR(lidars[1].range_bias.bias() - lidars[0].range_bias.bias(), 0.03, 0.008);
}

TEST_P(FrontAndRearLidarTest, KeepsThePoseIfOneFallsSilent) {
  SimulatedDrive drive = start();
  drive.drive(5.0, [](const Observation&) {});
  drive.on_scan = [](Scan* scan) { return scan->lidar == 0; };
  Errors errors;
  drive.drive(10.0, [&](const Observation& seen) { errors.add(seen); });
  EXPECT_GT(errors.scans, 190);
  EXPECT_LT(errors.sum / errors.scans, 0.03);
  EXPECT_EQ(drive.localizer().status().state, LocalizationState::kLocalized);
}

TEST_P(FrontAndRearLidarTest, FindsItselfFromAnUnknownPose) {
  SimulatedDrive drive = start();
  drive.localizer().initializeGlobally();
  double error = 0.0;
  drive.drive(10.0, [&](const Observation& seen) { error = seen.error; });
  EXPECT_LT(error, 0.1);
  EXPECT_EQ(drive.localizer().status().state, LocalizationState::kLocalized);
}

INSTANTIATE_TEST_SUITE_P(Maps, CorridorLidarTest, ::testing::Values("corridor"));
INSTANTIATE_TEST_SUITE_P(Maps, FrontAndRearLidarTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
