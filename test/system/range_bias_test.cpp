// Online estimation of the range bias on simulated drives.
#include <gtest/gtest.h>

#include <string>

#include "offline/simulated_drive.h"

namespace racecar_mcl {
namespace {

class RangeBiasDriveTest : public ::testing::TestWithParam<const char*> {
 protected:
  /// The estimate after `seconds` at 3 m/s with a lidar of this bias (m).
  double estimateAfter(double seconds, double bias) const {
    sim::SimulatorParameters simulator;
    simulator.lidar.range_bias = bias;
    Random random(5);
    const Pose2 start = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive drive(course_, parameters_, simulator, start, 3.0, 5);
    drive.localizer().initialize({start, Eigen::Matrix3d::Zero()});
    drive.drive(seconds, [](const Observation&) {});
    return drive.localizer().lidars().front().range_bias.bias();
  }

  LocalizerParameters parameters_;
  Course course_ =
      loadCourse(std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml", parameters_);
};

TEST_P(RangeBiasDriveTest, IsFoundAfterTwentyMetres) {
  // The map has a bias of its own: its walls are drawn in whole cells.
  const double of_map = estimateAfter(8.0, 0.0);
  EXPECT_NEAR(of_map, 0.0, 0.025);
  for (const double bias : {-0.05, -0.03, 0.03, 0.05}) {
    EXPECT_NEAR(estimateAfter(8.0, bias) - of_map, bias, 0.005) << bias;
  }
}

INSTANTIATE_TEST_SUITE_P(Maps, RangeBiasDriveTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
