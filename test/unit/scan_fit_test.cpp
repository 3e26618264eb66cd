#include "racecar_mcl/scan_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/wall_ahead.h"

namespace racecar_mcl {
namespace {

using Matches = std::vector<BeamMatch>;

class ScanFitTest : public WallAhead {
 protected:
  ScanFit fit(float range) { return fitScan(map_.get(), car_, beamsAhead(10, range)); }
};

TEST_F(ScanFitTest, ExplainsBeamsThatEndAtTheWall) {
  const ScanFit at_wall = fit(3.05f);
  EXPECT_EQ(at_wall.beams, 10);
  EXPECT_EQ(at_wall.explained, 1.0);
  EXPECT_EQ(at_wall.obstructed + at_wall.contradicted + at_wall.unmapped, 0.0);
}

TEST_F(ScanFitTest, IsObstructedByWhatTheMapDoesNotShow) {
  const ScanFit before_wall = fit(1.5f);
  EXPECT_EQ(before_wall.explained, 0.0);
  EXPECT_EQ(before_wall.obstructed, 1.0);
}

TEST_F(ScanFitTest, IsContradictedByBeamsThatPassAWall) {
  const ScanFit past_wall = fit(11.0f);  // at the wall behind the wall
  EXPECT_EQ(past_wall.explained, 0.0);
  EXPECT_EQ(past_wall.contradicted, 1.0);
}

TEST_F(ScanFitTest, DoesNotJudgeBeamsThatProveNothing) {
  for (const float nothing : {std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN(), 40.0f, 0.05f}) {
    const ScanFit fit_of_nothing = fit(nothing);
    EXPECT_EQ(fit_of_nothing.beams, 0) << nothing;
    EXPECT_EQ(fit_of_nothing.explained + fit_of_nothing.obstructed + fit_of_nothing.contradicted +
                  fit_of_nothing.unmapped,
              0.0);
  }
}

TEST_F(ScanFitTest, SharesAreOfTheBeamsThatCouldBeJudged) {
  Scan scan = beamsAhead(10, 3.05f);
  scan.ranges[0] = 0.05f;                                   // covered
  scan.ranges[1] = std::numeric_limits<float>::infinity();  // no return
  scan.ranges[2] = scan.ranges[3] = 1.5f;                   // short
  scan.ranges[4] = scan.ranges[5] = scan.ranges[6] = 6.0f;  // through
  const ScanFit mixed = fitScan(map_.get(), car_, scan);
  EXPECT_EQ(mixed.beams, 8);
  EXPECT_DOUBLE_EQ(mixed.obstructed, 2.0 / 8.0);
  EXPECT_DOUBLE_EQ(mixed.contradicted, 3.0 / 8.0);
  EXPECT_DOUBLE_EQ(mixed.explained, 3.0 / 8.0);
}

/// 20 x 6 m of free space between walls of one cell, unknown beyond its left third, with a pillar
/// and a filled area. The car stands at (10, 3); beams are made by where they end.
class ScanMatcherTest : public ::testing::Test {
 protected:
  static OccupancyGrid map() {
    constexpr double kResolution = 0.05;
    constexpr int kColumns = 400, kRows = 120;
    std::vector<std::int8_t> cells;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const double x = (column + 0.5) * kResolution, y = (row + 0.5) * kResolution;
        const bool wall = row == 0 || row == kRows - 1 || column == kColumns - 1;
        const bool pillar = x > 12.0 && x < 12.3 && y > 2.9 && y < 3.0;
        const bool filled = x > 10.0 && x < 14.0 && y > 4.0;
        cells.push_back(x < 6.0                    ? OccupancyGrid::kUnknown
                        : wall || pillar || filled ? OccupancyGrid::kOccupied
                                                   : OccupancyGrid::kFree);
      }
    }
    return OccupancyGrid({kColumns, kRows, kResolution, {}}, std::move(cells));
  }

  Scan beamsTo(const std::vector<Eigen::Vector2d>& ends) const {
    Scan scan;
    const auto count = static_cast<Eigen::Index>(ends.size());
    scan.bearings.resize(count);
    scan.ranges.resize(count);
    scan.seconds_after_stamp = Eigen::ArrayXf::Zero(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Vector2d way =
          ends[static_cast<std::size_t>(k)] - Eigen::Vector2d(car_.x, car_.y);
      scan.bearings[k] = static_cast<float>(std::atan2(way.y(), way.x()));
      scan.ranges[k] = static_cast<float>(way.norm());
    }
    return scan;
  }

  Matches match(const std::vector<Eigen::Vector2d>& ends) {
    return matcher_.match(map_.get(), car_, beamsTo(ends));
  }

  const Pose2 car_{10.0, 3.0, 0.0};
  std::shared_ptr<MapModel> map_ = makeMapModel(map(), SensorParameters{});
  ScanMatcher matcher_;
};

TEST_F(ScanMatcherTest, TakesAnEndWithinAFifthOfAMetreOfASurfaceForAMatch) {
  for (const double off : {-0.17, 0.0, 0.17}) {
    EXPECT_EQ(match({{10.0, 0.025 + off}}), Matches{BeamMatch::kMatched}) << off;
    EXPECT_EQ(match({{12.0, 4.025 + off}}), Matches{BeamMatch::kMatched}) << off;
  }
}

TEST_F(ScanMatcherTest, TakesAnEndInKnownFreeSpaceForShort) {
  EXPECT_EQ(match({{10.0, 0.3}, {8.0, 2.0}}), (Matches{BeamMatch::kShort, BeamMatch::kShort}));
}

TEST_F(ScanMatcherTest, TakesAnEndInTheUnknownForUnmapped) {
  EXPECT_EQ(match({{5.0, 3.0}, {3.0, 2.0}}), (Matches{BeamMatch::kUnmapped, BeamMatch::kUnmapped}));
  EXPECT_EQ(match({{-5.0, 3.0}}), Matches{BeamMatch::kUnmapped}) << "nothing is known beyond it";
}

TEST_F(ScanMatcherTest, TakesAnEndHalfAMetreBehindASurfaceForThrough) {
  EXPECT_EQ(match({{10.0, -0.6}}), Matches{BeamMatch::kThrough});
  EXPECT_EQ(match({{12.0, 5.0}}), Matches{BeamMatch::kThrough});
}

TEST_F(ScanMatcherTest, TakesAnEndInsideAnObstacleForThrough) {
  EXPECT_EQ(match({{12.0, 4.35}}), Matches{BeamMatch::kThrough});
}

TEST_F(ScanMatcherTest, TakesAMatchBehindAPillarThatItsNeighbourMissesForGrazing) {
  // Past the pillar's edge, 0.02 rad from it.
  const Eigen::Vector2d behind(19.975, 2.8), beside(19.975, 3.1);
  EXPECT_EQ(match({behind, beside}), (Matches{BeamMatch::kGrazing, BeamMatch::kMatched}));
  EXPECT_EQ(match({beside, behind}), (Matches{BeamMatch::kMatched, BeamMatch::kGrazing}));
}

TEST_F(ScanMatcherTest, TakesItForThroughWhereNoNeighbourMissesThePillar) {
  const Eigen::Vector2d behind(19.975, 2.8), also_behind(19.975, 2.7);
  EXPECT_EQ(match({behind, also_behind}), (Matches{BeamMatch::kThrough, BeamMatch::kThrough}));
  // 0.1 rad apart are no neighbours.
  const Eigen::Vector2d far_beside(19.975, 3.8);
  EXPECT_EQ(match({behind, far_beside}), (Matches{BeamMatch::kThrough, BeamMatch::kMatched}));
}

TEST_F(ScanMatcherTest, CountsGrazingBeamsForNothing) {
  const ScanFit fit = matcher_.fit(map_.get(), car_, beamsTo({{19.975, 2.8}, {19.975, 3.1}}));
  EXPECT_EQ(fit.beams, 2);
  EXPECT_EQ(fit.explained, 0.5);
  EXPECT_EQ(fit.obstructed + fit.contradicted + fit.unmapped, 0.0);
}

TEST_F(ScanMatcherTest, MatchesOneScanAfterAnotherAsIfItWereTheFirst) {
  const std::vector<std::vector<Eigen::Vector2d>> scans{
      {{10.0, 0.025}, {10.0, -0.6}, {5.0, 3.0}}, {{10.0, 0.3}}, {{5.0, 3.0}, {10.0, 0.025}}};
  for (const std::vector<Eigen::Vector2d>& ends : scans) {
    EXPECT_EQ(match(ends), ScanMatcher().match(map_.get(), car_, beamsTo(ends)));
  }
}

}  // namespace
}  // namespace racecar_mcl
