// One wrong stamp among the messages of a car at 4 m/s.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "offline/simulated_drive.h"

namespace racecar_mcl {
namespace {

constexpr double kSpeed = 4.0;       // m/s
constexpr double kBefore = 3.0;      // s, of the drive before the wrong stamp
constexpr double kAfter = 2.0;       // s
constexpr double kMaxGrowth = 0.05;  // m, of the position error, by one wrong stamp

/// The position error, m, by the scan's true stamp in ms.
using Errors = std::map<long, double>;

class WrongStamp : public testing::TestWithParam<bool> {
 protected:
  /// Drives a lap in which one message after `kBefore` has this error of its stamp, s.
  Errors errorsWith(double wrong) const {
    SimulatedDrive drive(course_, parameters_, {}, start_, kSpeed, 1);
    PoseEstimate start{start_, Eigen::Matrix3d::Zero()};
    start.covariance.diagonal() << 0.01, 0.01, 0.0025;
    drive.localizer().initialize(start);
    const double time = drive.simulator().time() + kBefore;
    bool is_done = false;
    double spoilt = -1.0;  // the wrong stamp of a scan
    const auto spoil = [&](double* stamp) {
      if (is_done || *stamp < time) return false;
      is_done = true;
      *stamp += wrong;
      return true;
    };
    if (GetParam()) {
      drive.on_scan = [&](Scan* scan) {
        if (spoil(&scan->stamp)) spoilt = scan->stamp;
        return true;
      };
    } else {
      drive.on_odometry = [&](OdometrySample* sample) { return spoil(&sample->stamp), true; };
    }
    Errors errors;
    drive.drive(kBefore + kAfter, [&](const Observation& seen) {
      if (seen.result.stamp == spoilt && wrong != 0.0) return;
      errors[std::lround(1e3 * seen.result.stamp)] = seen.error;
    });
    EXPECT_TRUE(is_done);
    EXPECT_GT(drive.simulator().truth().twist.vx, 0.5 * kSpeed);
    EXPECT_EQ(drive.localizer().counters().time_jumps, 0u) << wrong;
    return errors;
  }

  LocalizerParameters parameters_;
  const std::string map_ = RACECAR_MCL_SOURCE_DIR "/maps/track.yaml";
  Course course_ = loadCourse(map_, parameters_);
  Pose2 start_ = [this] {
    Pose2 start;
    EXPECT_TRUE(sim::loadStartPose(map_, start));
    return start;
  }();
};

TEST_P(WrongStamp, OfAnySizeMovesThePoseByAtMostFiveCentimetres) {
  const Errors without = errorsWith(0.0);
  for (const double wrong : {-30.0, -1.5, -0.9, -0.1, 0.04, 0.1, 0.2, 0.5, 0.9, 1.5, 30.0}) {
    double growth = 0.0;
    for (const auto& [stamp, error] : errorsWith(wrong)) {
      const auto same = without.find(stamp);
      if (same != without.end()) growth = std::max(growth, error - same->second);
    }
    EXPECT_LT(growth, kMaxGrowth) << "a stamp wrong by " << wrong << " s";
  }
}

INSTANTIATE_TEST_SUITE_P(, WrongStamp, testing::Bool(), [](const auto& parameter) {
  return parameter.param ? "Scan" : "Odometry";
});

}  // namespace
}  // namespace racecar_mcl
