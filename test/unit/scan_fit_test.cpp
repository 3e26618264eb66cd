#include "racecar_mcl/scan_fit.h"

#include <gtest/gtest.h>

#include "racecar_mcl/particle_filter.h"
#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

class ScanFitTest : public ::testing::Test {
 protected:
  /// Ten beams ahead, from 3 m before the wall at x = 11.
  static Scan aheadOf(float range) {
    Scan scan;
    scan.bearings = Eigen::ArrayXf::LinSpaced(10, -0.1f, 0.1f);
    scan.ranges = Eigen::ArrayXf::Constant(10, range);
    scan.seconds_after_stamp = Eigen::ArrayXf::Zero(10);
    return scan;
  }

  ScanFit fit(float range) { return fitScan(map_.get(), {8.0, 4.0, 0.0}, aheadOf(range)); }

  std::shared_ptr<MapModel> map_ = makeMapModel(asciiMap(R"(
      ####################
      #..........#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      #..........#.......#
      ####################)"),
                                                SensorParameters{});
};

TEST_F(ScanFitTest, ExplainsBeamsThatEndAtTheWall) {
  const ScanFit at_wall = fit(3.05f);
  EXPECT_EQ(at_wall.beams, 10);
  EXPECT_EQ(at_wall.explained, 1.0);
}

TEST_F(ScanFitTest, DoesNotExplainWhatTheMapDoesNotShow) { EXPECT_EQ(fit(1.5f).explained, 0.0); }

TEST_F(ScanFitTest, DoesNotExplainBeamsThatPassAWall) {
  EXPECT_EQ(fit(11.0f).explained, 0.0);  // at the wall behind the wall
}

TEST_F(ScanFitTest, DoesNotJudgeBeamsThatProveNothing) {
  EXPECT_EQ(fit(std::numeric_limits<float>::infinity()).beams, 0);
  EXPECT_EQ(fit(0.05f).beams, 0) << "a covered lidar";
}

}  // namespace
}  // namespace racecar_mcl
