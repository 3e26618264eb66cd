#include "racecar_mcl/scan.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <stdexcept>

#include "racecar_mcl/odometry.h"
#include "support/room.h"

namespace racecar_mcl {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Beams 1 degree apart about the lidar's x axis; the range of beam i is 1 + i.
Scan fan(int count) {
  Scan scan;
  scan.stamp = 12.5;
  scan.laser_in_base = {0.27, 0.01, 0.02};
  const double first = -(count - 1) / 2.0;
  scan.bearings = (Eigen::ArrayXf::LinSpaced(count, 0.0f, static_cast<float>(count - 1)) +
                   static_cast<float>(first)) *
                  static_cast<float>(kPi / 180.0);
  scan.ranges = Eigen::ArrayXf::LinSpaced(count, 1.0f, static_cast<float>(count));
  scan.seconds_after_stamp = 1e-3f * Eigen::ArrayXf::LinSpaced(count, 0.0f, count - 1.0f);
  return scan;
}

TEST(SelectBeams, TakesExactlyAsManyAsAskedFromEndToEnd) {
  const Scan scan = fan(1081);
  for (const int count : {2, 3, 50, 99, 100, 1080, 1081}) {
    const Scan chosen = selectBeams(scan, count, 2 * kPi);
    ASSERT_EQ(chosen.size(), count);
    EXPECT_EQ(chosen.ranges[0], 1.0f);
    EXPECT_EQ(chosen.ranges[count - 1], 1081.0f);
  }
}

TEST(SelectBeams, SpreadsEvenlyAndRepeatsNone) {
  const Scan chosen = selectBeams(fan(1081), 100, 2 * kPi);
  for (Eigen::Index k = 1; k < chosen.size(); ++k) {
    // 1080 steps in 99: 10.9 beams apart.
    const float step = chosen.ranges[k] - chosen.ranges[k - 1];
    EXPECT_GE(step, 10.0f);
    EXPECT_LE(step, 11.0f);
  }
}

TEST(SelectBeams, KeepsEachBeamsParts) {
  const Scan scan = fan(90);
  const Scan chosen = selectBeams(scan, 7, 2 * kPi);
  EXPECT_EQ(chosen.stamp, scan.stamp);
  EXPECT_EQ(chosen.laser_in_base.x, scan.laser_in_base.x);
  EXPECT_EQ(chosen.laser_in_base.y, scan.laser_in_base.y);
  EXPECT_EQ(chosen.laser_in_base.yaw, scan.laser_in_base.yaw);
  for (Eigen::Index k = 0; k < chosen.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(chosen.ranges[k]) - 1;
    EXPECT_EQ(chosen.bearings[k], scan.bearings[i]);
    EXPECT_EQ(chosen.seconds_after_stamp[k], scan.seconds_after_stamp[i]);
  }
}

TEST(SelectBeams, ChoosesAmongTheValidOnes) {
  // Half of the beams are no returns; asked are 60 and the 60 come from the other half.
  Scan scan = fan(200);
  for (Eigen::Index i = 50; i < 150; ++i) {
    scan.ranges[i] = i % 4 == 0 ? kNan : i % 4 == 1 ? -kInf : i % 4 == 2 ? -1.0f : 0.0f;
  }
  const Scan chosen = selectBeams(scan, 60, 2 * kPi);
  ASSERT_EQ(chosen.size(), 60);
  EXPECT_TRUE((chosen.ranges > 0.0f).all());
  EXPECT_EQ((chosen.ranges <= 50.0f).count(), 30);
}

TEST(SelectBeams, DropsBeamsWithoutDirectionOrTime) {
  Scan scan = fan(10);
  scan.bearings[2] = kNan;
  scan.bearings[3] = kInf;
  scan.seconds_after_stamp[4] = kNan;
  const Scan chosen = selectBeams(scan, 10, 7.0);
  EXPECT_EQ(chosen.size(), 7);
  EXPECT_TRUE(chosen.bearings.isFinite().all());
  EXPECT_TRUE(chosen.seconds_after_stamp.isFinite().all());
}

TEST(SelectBeams, KeepsBeamsThatMetNothing) {
  Scan scan = fan(10);
  scan.ranges[4] = kInf;
  EXPECT_EQ(selectBeams(scan, 10, 2 * kPi).ranges[4], kInf);
}

TEST(SelectBeams, TakesAllWhereFewerAreThereThanAsked) {
  EXPECT_EQ(selectBeams(fan(23), 60, 2 * kPi).size(), 23);
  EXPECT_EQ(selectBeams(fan(1), 60, 2 * kPi).size(), 1);
  EXPECT_EQ(selectBeams(Scan{}, 60, 2 * kPi).size(), 0);
  EXPECT_EQ(selectBeams(fan(23), 0, 2 * kPi).size(), 0);
}

TEST(SelectBeams, TakesTheMiddleForASingleBeam) {
  EXPECT_EQ(selectBeams(fan(181), 1, 2 * kPi).ranges[0], 91.0f);
}

TEST(SelectBeams, StaysInsideTheFieldOfView) {
  // 41 beams lie within 20 degrees to either side.
  const double degree = kPi / 180.0;
  EXPECT_EQ(selectBeams(fan(181), 1000, 40.2 * degree).size(), 41);
  const Scan chosen = selectBeams(fan(181), 10, 40.2 * degree);
  EXPECT_NEAR(chosen.bearings[0], -20.0 * degree, 1e-5);
  EXPECT_NEAR(chosen.bearings[9], 20.0 * degree, 1e-5);
}

TEST(SelectBeams, AFullTurnKeepsTheBeamBehind) {
  Scan scan = fan(3);
  scan.bearings << static_cast<float>(kPi), 0.0f, static_cast<float>(-kPi);
  EXPECT_EQ(selectBeams(scan, 3, 2 * kPi).size(), 3);
}

/// Where a beam ends on a corridor's wall, and round that corridor from its front: m, left
/// positive.
double wayRoundCorridor(double bearing, double half_length, double half_width) {
  const double c = std::cos(bearing), s = std::sin(bearing);
  const double range = std::min(half_length / std::abs(c), half_width / std::abs(s));
  const double x = range * c, y = range * s;
  if (std::abs(std::abs(y) - half_width) < 1e-6) {
    return std::copysign(half_width + half_length - x, y);
  }
  return x > 0.0 ? y : std::copysign(2.0 * half_width + 2.0 * half_length - std::abs(y), y);
}

TEST(SelectBeamsBoxed, SpacesEndPointsEvenlyOnTheWallsOfACorridor) {
  // A Hokuyo's 1081 beams over 270 degrees; a corridor of 2 m by 6 m.
  Scan scan = fan(1081);
  scan.bearings *= 0.25f;
  scan.laser_in_base.yaw = 0.0;
  const Scan chosen = selectBeamsBoxed(scan, 60, 2 * kPi, 3.0);
  ASSERT_EQ(chosen.size(), 60);
  std::vector<double> way;
  for (Eigen::Index k = 0; k < chosen.size(); ++k) {
    way.push_back(wayRoundCorridor(static_cast<double>(chosen.bearings[k]), 3.0, 1.0));
  }
  const double step = (way.back() - way.front()) / 59.0;
  // Towards a far corner one beam ends up to 0.045 m from the next.
  for (std::size_t k = 1; k < way.size(); ++k) EXPECT_NEAR(way[k] - way[k - 1], step, 0.05);
  EXPECT_EQ(chosen.ranges[0], 1.0f);
  EXPECT_EQ(chosen.ranges[59], 1081.0f);
}

TEST(SelectBeamsBoxed, LooksFartherAheadTheLongerTheBox) {
  const auto ahead = [](double aspect) {
    return (selectBeamsBoxed(fan(271), 50, 2 * kPi, aspect).bearings.abs() < 0.5f).count();
  };
  EXPECT_LT(ahead(0.5), ahead(1.0));
  EXPECT_LT(ahead(1.0), ahead(4.0));
}

TEST(SelectBeamsBoxed, LaysTheBoxAlongTheCarHoweverTheLidarIsMounted) {
  for (const double mounted : {0.5 * kPi, -2.0, kPi}) {
    Scan scan = fan(361);  // all round
    scan.laser_in_base = {0.1, 0.0, mounted};
    const Scan chosen = selectBeamsBoxed(scan, 60, 2 * kPi, 4.0);
    ASSERT_EQ(chosen.size(), 60);
    int ahead = 0, beside = 0;
    for (Eigen::Index k = 0; k < chosen.size(); ++k) {
      const double bearing = wrapAngle(static_cast<double>(chosen.bearings[k]) + mounted);
      if (std::abs(bearing) < 0.3) ++ahead;
      if (std::abs(bearing - 0.5 * kPi) < 0.3) ++beside;
    }
    EXPECT_GT(ahead, 3 * beside) << mounted;
  }
}

TEST(SelectBeamsBoxed, FavoursNoSideWhereTheLidarLooksBack) {
  Scan scan = fan(1081);
  scan.bearings *= 0.25f;  // 270 degrees
  scan.laser_in_base = {0.0, 0.0, kPi};
  const Scan chosen = selectBeamsBoxed(scan, 240, 2 * kPi, 2.0);
  ASSERT_EQ(chosen.size(), 240);
  EXPECT_NEAR(static_cast<double>((chosen.bearings < 0.0f).count()), 120.0, 3.0);
  for (const float edge : {0.5f, 1.0f, 1.5f, 2.0f}) {
    EXPECT_NEAR(static_cast<double>((chosen.bearings > edge).count()),
                static_cast<double>((chosen.bearings < -edge).count()), 4.0)
        << edge;
  }
}

TEST(SelectBeamsBoxed, TakesNoneTwiceAndAllWhereFewAreThere) {
  for (const int count : {1, 2, 30, 180, 181, 400}) {
    const Scan chosen = selectBeamsBoxed(fan(181), count, 2 * kPi, 20.0);
    ASSERT_EQ(chosen.size(), std::min(count, 181));
    for (Eigen::Index k = 1; k < chosen.size(); ++k) {
      EXPECT_LT(chosen.ranges[k - 1], chosen.ranges[k]);
    }
  }
  EXPECT_EQ(selectBeamsBoxed(Scan{}, 60, 2 * kPi, 3.0).size(), 0);
  EXPECT_EQ(selectBeamsBoxed(fan(23), 0, 2 * kPi, 3.0).size(), 0);
}

TEST(SelectBeamsBoxed, ChoosesAmongTheValidOnesOfAFullTurnInAnyOrder) {
  Scan scan = fan(360);
  scan.bearings.reverseInPlace();
  for (Eigen::Index i = 0; i < 360; i += 2) scan.ranges[i] = kNan;
  const Scan chosen = selectBeamsBoxed(scan, 60, 2 * kPi, 3.0);
  ASSERT_EQ(chosen.size(), 60);
  EXPECT_TRUE((chosen.ranges > 0.0f).all());
  for (Eigen::Index k = 1; k < chosen.size(); ++k) {
    EXPECT_LT(chosen.bearings[k - 1], chosen.bearings[k]);
  }
  EXPECT_NEAR(static_cast<double>((chosen.bearings < 0.0f).count()), 30.0, 1.0);
}

TEST(SelectBeams, RefusesArraysOfDifferentLengths) {
  Scan scan = fan(10);
  scan.ranges.conservativeResize(9);
  EXPECT_THROW(selectBeams(scan, 5, 1.0), std::invalid_argument);
  EXPECT_THROW(selectBeamsBoxed(scan, 5, 1.0, 3.0), std::invalid_argument);
  scan = fan(10);
  scan.seconds_after_stamp.resize(0);
  EXPECT_THROW(selectBeams(scan, 5, 1.0), std::invalid_argument);
}

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

  /// The farthest that any end point lies from the walls, for a lidar still at the start.
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

TEST_P(Deskew, PutsEveryEndOnTheWalls) {
  const Scan bent = sweep();
  EXPECT_GT(worstMiss(bent), 0.02);  // or this test shows nothing
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
  OdometryHistory history;
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

TEST(DeskewBeams, OnlyTurnsBeamsThatMetNothing) {
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

TEST(DeskewBeams, LeavesAStandingCarsScanAlone) {
  const Scan scan = fan(181);
  const Scan straight = deskew(scan, [](double) { return Pose2{}; });
  EXPECT_LT((straight.ranges - scan.ranges).abs().maxCoeff(), 2e-5f);
  EXPECT_LT((straight.bearings - scan.bearings).abs().maxCoeff(), 1e-6f);
}

}  // namespace
}  // namespace racecar_mcl
