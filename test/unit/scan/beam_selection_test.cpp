#include "racecar_mcl/scan/beam_selection.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <stdexcept>

#include "support/scans.h"

namespace racecar_mcl {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(SelectBeams, SelectsTheRequestedNumberFromEndToEnd) {
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
  // Half of the beams are invalid; the 60 selected beams are from the other half.
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

TEST(SelectBeams, KeepsBeamsWithoutReturn) {
  Scan scan = fan(10);
  scan.ranges[4] = kInf;
  EXPECT_EQ(selectBeams(scan, 10, 2 * kPi).ranges[4], kInf);
}

TEST(SelectBeams, SelectsAllIfThereAreFewer) {
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

/// The arc length (m, positive to the left) along the walls of a corridor from its front to a
/// beam's end point.
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
  // Near a far corner, end points of neighbouring beams are up to 0.045 m apart.
  for (std::size_t k = 1; k < way.size(); ++k) EXPECT_NEAR(way[k] - way[k - 1], step, 0.05);
  EXPECT_EQ(chosen.ranges[0], 1.0f);
  EXPECT_EQ(chosen.ranges[59], 1081.0f);
}

TEST(SelectBeamsBoxed, SelectsMoreBeamsAheadForALongerBox) {
  const auto ahead = [](double aspect) {
    return (selectBeamsBoxed(fan(271), 50, 2 * kPi, aspect).bearings.abs() < 0.5f).count();
  };
  EXPECT_LT(ahead(0.5), ahead(1.0));
  EXPECT_LT(ahead(1.0), ahead(4.0));
}

TEST(SelectBeamsBoxed, AlignsTheBoxWithTheCarForAnyMounting) {
  for (const double mounted : {0.5 * kPi, -2.0, kPi}) {
    Scan scan = fan(361);  // a full turn
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

TEST(SelectBeamsBoxed, IsSymmetricForALidarThatLooksBack) {
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

TEST(SelectBeamsBoxed, SelectsNoneTwiceAndAllIfThereAreFew) {
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

TEST(SelectBeams, RejectsArraysOfDifferentLengths) {
  Scan scan = fan(10);
  scan.ranges.conservativeResize(9);
  EXPECT_THROW(selectBeams(scan, 5, 1.0), std::invalid_argument);
  EXPECT_THROW(selectBeamsBoxed(scan, 5, 1.0, 3.0), std::invalid_argument);
  scan = fan(10);
  scan.seconds_after_stamp.resize(0);
  EXPECT_THROW(selectBeams(scan, 5, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace racecar_mcl
