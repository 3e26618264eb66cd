#include "racecar_mcl/sensor/unmapped_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "support/ascii_map.h"

namespace racecar_mcl {
namespace {

constexpr double kResolution = 0.1;  // m

// A hall whose right wall is missing in rows 3 to 12; a lidar may see whatever stands there.
OccupancyGrid hall() {
  std::string drawing;
  for (int row = 15; row >= 0; --row) {
    const bool is_wall = row == 0 || row == 15;
    const std::string right = row >= 3 && row <= 12 ? "????????" : "#???????";
    drawing += (is_wall ? std::string(11, '#') : "#..........") + right + "\n";
  }
  return asciiMap(drawing, kResolution);
}

const Pose2 kLidar{0.55, 0.85, 0.0};

/// Beams whose ends have the given x, at these y (m, map frame).
Scan beamsTo(double x, std::initializer_list<double> ys) {
  Scan scan;
  const auto count = static_cast<Eigen::Index>(ys.size());
  scan.bearings.resize(count);
  scan.ranges.resize(count);
  scan.seconds_after_stamp = Eigen::ArrayXf::Zero(count);
  Eigen::Index k = 0;
  for (const double y : ys) {
    scan.bearings[k] = static_cast<float>(std::atan2(y - kLidar.y, x - kLidar.x));
    scan.ranges[k++] = static_cast<float>(std::hypot(x - kLidar.x, y - kLidar.y));
  }
  return scan;
}

class UnmappedSpaceTest : public ::testing::Test {
 protected:
  bool hasMissingSurface(const Scan& scan) const { return space_.hasMissingSurface(kLidar, scan); }

  static LikelihoodFieldParameters parameters() {
    LikelihoodFieldParameters p;
    p.unmapped_likelihood = 0.5;
    p.likelihood_exponent = 1.0;
    return p;
  }

  const OccupancyGrid grid_ = hall();
  const UnmappedSpace space_ = *findUnmappedSpace(grid_, findSurfaces(grid_), parameters());
};

TEST_F(UnmappedSpaceTest, HasAMissingSurfaceWhereBeamsEndAlongHalfAMetre) {
  EXPECT_TRUE(hasMissingSurface(beamsTo(1.15, {0.55, 0.7, 0.9, 1.1})));
  EXPECT_FALSE(hasMissingSurface(beamsTo(1.15, {0.65, 0.8, 1.0}))) << "0.35 m";
}

TEST_F(UnmappedSpaceTest, IgnoresTwoOtherBeamsInBetween) {
  Scan scan = beamsTo(1.15, {0.45, 0.6, 0.7, 0.8, 1.1});
  scan.ranges[1] = scan.ranges[2] = 0.2f;  // a box
  EXPECT_TRUE(hasMissingSurface(scan));
  scan.ranges[3] = 0.2f;
  EXPECT_FALSE(hasMissingSurface(scan));
}

TEST_F(UnmappedSpaceTest, HasNoneWhereBeamsPassThroughOrEndElsewhere) {
  EXPECT_FALSE(hasMissingSurface(beamsTo(1.45, {0.4, 0.7, 0.9, 1.2}))) << "behind the opening";
  EXPECT_FALSE(hasMissingSurface(beamsTo(2.65, {0.4, 0.7, 0.9, 1.2}))) << "beyond";
  EXPECT_FALSE(hasMissingSurface(beamsTo(0.85, {0.4, 0.7, 0.9, 1.2}))) << "before";
  EXPECT_FALSE(hasMissingSurface(beamsTo(0.05, {0.4, 0.7, 0.9, 1.2}))) << "on a wall";
  Scan none = beamsTo(1.15, {0.4, 0.7, 0.9, 1.2});
  none.ranges.setConstant(std::numeric_limits<float>::infinity());
  EXPECT_FALSE(hasMissingSurface(none)) << "without a return";
}

TEST_F(UnmappedSpaceTest, IsNotOnAMapWithoutOpenings) {
  const OccupancyGrid closed = asciiMap(R"(
      #########
      #.......#
      #.......#
      #.......#
      #.......#
      #.......#
      #.......#
      #########)",
                                        kResolution);
  EXPECT_FALSE(findUnmappedSpace(closed, findSurfaces(closed), parameters()));
}

TEST_F(UnmappedSpaceTest, IsNotWithoutALikelihoodAboveThatOfRandomBeams) {
  LikelihoodFieldParameters p = parameters();
  p.unmapped_likelihood = p.z_rand;
  EXPECT_FALSE(findUnmappedSpace(grid_, findSurfaces(grid_), p));
}

TEST_F(UnmappedSpaceTest, ABeamThatEndsThereIsNoEvidence) {
  const LikelihoodField& field = space_.field();
  const LikelihoodField plain(grid_, parameters());
  const auto logLikelihood = [](const LikelihoodField& of, double x, double y) {
    return double{of.beamLogLikelihoods(kLidar, beamsTo(x, {y}))[0]};
  };
  EXPECT_NEAR(logLikelihood(field, 1.15, 0.85), std::log(0.5), 0.01);
  EXPECT_NEAR(logLikelihood(field, 1.75, 0.85), std::log(0.5), 0.01) << "deeper";
  EXPECT_LT(logLikelihood(plain, 1.15, 0.85), std::log(0.12));
  for (const double x : {0.05, 0.15, 0.35, 0.85}) {
    EXPECT_EQ(logLikelihood(field, x, 0.85), logLikelihood(plain, x, 0.85)) << x;
  }
}

}  // namespace
}  // namespace racecar_mcl
