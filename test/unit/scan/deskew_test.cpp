#include "racecar_mcl/scan/deskew.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <stdexcept>

#include "racecar_mcl/motion/odometry_buffer.h"
#include "support/analytic_room.h"
#include "support/scans.h"

namespace racecar_mcl {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct Drive {
  const char* name;
  Twist2 twist;
  Pose2 laser_in_base;
};

/// A Hokuyo's sweep, 1081 beams one after another over 19 ms.
class Deskew : public testing::TestWithParam<Drive> {
 protected:
  static constexpr double kStamp = 3.0;
  const Room room_{12.0, 7.0};
  const Pose2 start_{5.0, 3.0, 0.7};

  Scan sweep() const {
    const Sweep hokuyo{1081, 1.5 * kPi, 0.019, GetParam().laser_in_base};
    return takeScan(room_, hokuyo, kStamp, [&](double stamp) {
      return compose(start_, integrate(GetParam().twist, stamp - kStamp));
    });
  }

  /// The maximum distance of end points from the walls, with the lidar at its pose at the stamp.
  double worstMiss(const Scan& scan) const {
    const Pose2 lidar = compose(start_, scan.laser_in_base);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < scan.size(); ++i) {
      const Pose2 end = compose(compose(lidar, {0.0, 0.0, static_cast<double>(scan.bearings[i])}),
                                {static_cast<double>(scan.ranges[i]), 0.0, 0.0});
      worst = std::max(worst, room_.distanceToWall(end.x, end.y));
    }
    return worst;
  }
};

TEST_P(Deskew, MovesEveryEndPointOntoTheWalls) {
  const Scan bent = sweep();
  EXPECT_GT(worstMiss(bent), 0.02);  // the sweep is distorted
  const Scan straight =
      deskew(bent, [&](double seconds) { return integrate(GetParam().twist, seconds); });
  EXPECT_LT(worstMiss(straight), 1e-5);
}

TEST_P(Deskew, AgreesWithAScanTakenStandingStill) {
  const Scan straight =
      deskew(sweep(), [&](double seconds) { return integrate(GetParam().twist, seconds); });
  const Pose2 lidar = compose(start_, straight.laser_in_base);
  for (Eigen::Index i = 0; i < straight.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(straight.ranges[i]),
                room_.range(lidar, static_cast<double>(straight.bearings[i])), 2e-4);
  }
  EXPECT_EQ(straight.seconds_after_stamp.maxCoeff(), 0.0f);
  EXPECT_EQ(straight.stamp, kStamp);
}

TEST_P(Deskew, FollowsOdometryBetweenItsMessages) {
  OdometryBuffer history;
  for (int i = 0; i <= 10; ++i) {
    history.add({kStamp - 0.107 + i * 0.02, GetParam().twist, {}});
  }
  const OdometryState at_stamp = history.at(kStamp);
  const Scan straight = deskew(sweep(), [&](double seconds) {
    return motionBetween(at_stamp, history.at(kStamp + seconds)).delta;
  });
  EXPECT_LT(worstMiss(straight), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(
    Drives, Deskew,
    testing::Values(Drive{"straight", {7.0, 0.0, 0.0}, {}},
                    Drive{"turning", {7.0, 0.0, 3.0}, {0.27, 0.0, 0.0}},
                    Drive{"reversing", {-3.0, 0.0, -2.0}, {0.27, 0.1, 0.3}},
                    Drive{"spinning_lidar_backwards", {0.0, 0.0, 6.0}, {-0.2, 0.0, kPi}},
                    Drive{"sliding", {4.0, 2.0, -3.0}, {0.27, 0.0, -1.0}}),
    [](const auto& instance) { return instance.param.name; });

TEST(DeskewBeams, OnlyRotatesBeamsWithoutReturn) {
  Scan scan = fan(3);
  scan.laser_in_base = {0.3, 0.0, 0.1};
  scan.ranges.setConstant(kInf);
  scan.seconds_after_stamp << 0.0f, 0.5f, 1.0f;
  scan.bearings << -1.0f, 0.0f, 3.0f;
  const Scan straight = deskew(scan, [](double seconds) {
    return Pose2{4.0 * seconds, 0.0, 0.4 * seconds};
  });
  EXPECT_TRUE((straight.ranges == kInf).all());
  EXPECT_NEAR(straight.bearings[0], -1.0, 1e-6);
  EXPECT_NEAR(straight.bearings[1], 0.2, 1e-6);
  EXPECT_NEAR(straight.bearings[2], wrapAngle(3.4), 1e-6);
}

TEST(DeskewBeams, MovesEndPointsNextToTheLidarAndBehindIt) {
  Scan scan = fan(4);
  scan.laser_in_base = {};
  scan.ranges << 0.3f, 0.3f, 2.0f, 0.01f;
  scan.bearings << 0.0f, 0.5f, -3.0f, 1.0f;
  scan.seconds_after_stamp << 0.0f, 1.0f, 1.0f, 1.0f;
  const Pose2 last{-0.5, 0.2, 0.3};
  const Scan straight = deskew(scan, [&](double seconds) {
    return Pose2{seconds * last.x, seconds * last.y, seconds * last.yaw};
  });
  for (Eigen::Index i = 1; i < scan.size(); ++i) {
    const double bearing = static_cast<double>(scan.bearings[i]);
    const double range = static_cast<double>(scan.ranges[i]);
    const Pose2 end = compose(last, {range * std::cos(bearing), range * std::sin(bearing), 0.0});
    EXPECT_NEAR(static_cast<double>(straight.ranges[i]), std::hypot(end.x, end.y), 1e-6) << i;
    EXPECT_NEAR(static_cast<double>(straight.bearings[i]), std::atan2(end.y, end.x), 1e-6) << i;
  }
}

TEST(DeskewBeams, DoesNotChangeTheScanOfAStationaryCar) {
  const Scan scan = fan(181);
  const Scan straight = deskew(scan, [](double) { return Pose2{}; });
  EXPECT_LT((straight.ranges - scan.ranges).abs().maxCoeff(), 2e-5f);
  EXPECT_LT((straight.bearings - scan.bearings).abs().maxCoeff(), 1e-6f);
}

}  // namespace
}  // namespace racecar_mcl
