#include "racecar_mcl/monitoring/scan_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/single_wall.h"

namespace racecar_mcl {
namespace {

using Matches = std::vector<BeamMatch>;

class ScanMatchTest : public WallAhead {
 protected:
  ScanMatch match(float range) {
    return evaluateScanMatch(map_->view(), car_, beamsAhead(10, range));
  }
};

TEST_F(ScanMatchTest, BeamsThatEndAtTheWallAreInliers) {
  const ScanMatch at_wall = match(3.05f);
  EXPECT_EQ(at_wall.beams, 10);
  EXPECT_EQ(at_wall.inlier_ratio, 1.0);
  EXPECT_EQ(at_wall.obstructed + at_wall.contradicted + at_wall.unmapped, 0.0);
}

TEST_F(ScanMatchTest, BeamsThatEndBeforeTheWallAreObstructed) {
  const ScanMatch before_wall = match(1.5f);
  EXPECT_EQ(before_wall.inlier_ratio, 0.0);
  EXPECT_EQ(before_wall.obstructed, 1.0);
}

TEST_F(ScanMatchTest, BeamsThatPassTheWallAreContradicted) {
  const ScanMatch past_wall = match(11.0f);  // at the second wall
  EXPECT_EQ(past_wall.inlier_ratio, 0.0);
  EXPECT_EQ(past_wall.contradicted, 1.0);
}

TEST_F(ScanMatchTest, DoesNotEvaluateInvalidBeams) {
  for (const float invalid : {std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN(), 40.0f, 0.05f}) {
    const ScanMatch unevaluated = match(invalid);
    EXPECT_EQ(unevaluated.beams, 0) << invalid;
    EXPECT_EQ(unevaluated.inlier_ratio + unevaluated.obstructed + unevaluated.contradicted +
                  unevaluated.unmapped,
              0.0);
  }
}

TEST_F(ScanMatchTest, FractionsAreOfTheEvaluatedBeams) {
  Scan scan = beamsAhead(10, 3.05f);
  scan.ranges[0] = 0.05f;                                   // covered
  scan.ranges[1] = std::numeric_limits<float>::infinity();  // no return
  scan.ranges[2] = scan.ranges[3] = 1.5f;                   // short
  scan.ranges[4] = scan.ranges[5] = scan.ranges[6] = 6.0f;  // through
  const ScanMatch mixed = evaluateScanMatch(map_->view(), car_, scan);
  EXPECT_EQ(mixed.beams, 8);
  EXPECT_DOUBLE_EQ(mixed.obstructed, 2.0 / 8.0);
  EXPECT_DOUBLE_EQ(mixed.contradicted, 3.0 / 8.0);
  EXPECT_DOUBLE_EQ(mixed.inlier_ratio, 3.0 / 8.0);
}

/// 20 x 6 m of free space between walls of one cell, unknown beyond its left third, with a pillar
/// and a filled area. The car is at (10, 3); beams are given by their end points.
class ScanMatchEvaluatorTest : public ::testing::Test {
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
      const Eigen::Vector2d offset =
          ends[static_cast<std::size_t>(k)] - Eigen::Vector2d(car_.x, car_.y);
      scan.bearings[k] = static_cast<float>(std::atan2(offset.y(), offset.x()));
      scan.ranges[k] = static_cast<float>(offset.norm());
    }
    return scan;
  }

  Matches match(const std::vector<Eigen::Vector2d>& ends) {
    return matcher_.classifyBeams(map_->view(), car_, beamsTo(ends));
  }

  const Pose2 car_{10.0, 3.0, 0.0};
  std::shared_ptr<const LocalizationMap> map_ = makeLocalizationMap(map(), SensorParameters{});
  ScanMatchEvaluator matcher_;
};

TEST_F(ScanMatchEvaluatorTest, AnEndPointWithinAFifthOfAMetreOfASurfaceIsMatched) {
  for (const double off : {-0.17, 0.0, 0.17}) {
    EXPECT_EQ(match({{10.0, 0.025 + off}}), Matches{BeamMatch::kMatched}) << off;
    EXPECT_EQ(match({{12.0, 4.025 + off}}), Matches{BeamMatch::kMatched}) << off;
  }
}

TEST_F(ScanMatchEvaluatorTest, TakesAnInlierDistanceForEachBeam) {
  const Scan scan = beamsTo({{10.0, 0.15}, {10.0, 0.15}, {10.0, 0.4}});
  const Eigen::Array3f distances(0.1f, 0.15f, 0.5f);
  EXPECT_EQ(matcher_.classifyBeams(map_->view(), car_, scan, distances),
            (Matches{BeamMatch::kShort, BeamMatch::kMatched, BeamMatch::kMatched}));
  EXPECT_EQ(matcher_.classifyBeams(map_->view(), car_, scan),
            (Matches{BeamMatch::kMatched, BeamMatch::kMatched, BeamMatch::kShort}));
}

TEST_F(ScanMatchEvaluatorTest, GivesTheExpectedRanges) {
  match({{10.0, 1.0}, {5.0, 3.0}});
  EXPECT_NEAR(matcher_.expectedRanges()(0), 2.95, 0.03);
  EXPECT_TRUE(std::isnan(matcher_.expectedRanges()(1))) << "no surface";
}

TEST_F(ScanMatchEvaluatorTest, AnEndPointInFreeSpaceIsShort) {
  EXPECT_EQ(match({{10.0, 0.3}, {8.0, 2.0}}), (Matches{BeamMatch::kShort, BeamMatch::kShort}));
}

TEST_F(ScanMatchEvaluatorTest, AnEndPointInUnknownCellsIsUnmapped) {
  EXPECT_EQ(match({{5.0, 3.0}, {3.0, 2.0}}), (Matches{BeamMatch::kUnmapped, BeamMatch::kUnmapped}));
  EXPECT_EQ(match({{-5.0, 3.0}}), Matches{BeamMatch::kUnmapped}) << "outside the map";
}

TEST_F(ScanMatchEvaluatorTest, AnEndPointHalfAMetreBehindASurfaceIsThrough) {
  EXPECT_EQ(match({{10.0, -0.6}}), Matches{BeamMatch::kThrough});
  EXPECT_EQ(match({{12.0, 5.0}}), Matches{BeamMatch::kThrough});
}

TEST_F(ScanMatchEvaluatorTest, AnEndPointInsideAnObstacleIsThrough) {
  EXPECT_EQ(match({{12.0, 4.35}}), Matches{BeamMatch::kThrough});
}

TEST_F(ScanMatchEvaluatorTest, AMatchBehindAPillarThatItsNeighbourMissesIsGrazing) {
  // 0.02 rad from the pillar's edge.
  const Eigen::Vector2d behind(19.975, 2.8), beside(19.975, 3.1);
  EXPECT_EQ(match({behind, beside}), (Matches{BeamMatch::kGrazing, BeamMatch::kMatched}));
  EXPECT_EQ(match({beside, behind}), (Matches{BeamMatch::kMatched, BeamMatch::kGrazing}));
}

TEST_F(ScanMatchEvaluatorTest, AMatchBehindAPillarIsThroughIfNoNeighbourMissesIt) {
  const Eigen::Vector2d behind(19.975, 2.8), also_behind(19.975, 2.7);
  EXPECT_EQ(match({behind, also_behind}), (Matches{BeamMatch::kThrough, BeamMatch::kThrough}));
  // Beams 0.1 rad apart are no neighbours.
  const Eigen::Vector2d far_beside(19.975, 3.8);
  EXPECT_EQ(match({behind, far_beside}), (Matches{BeamMatch::kThrough, BeamMatch::kMatched}));
}

TEST_F(ScanMatchEvaluatorTest, GrazingBeamsAreNeitherInliersNorConflicts) {
  const ScanMatch match =
      matcher_.evaluate(map_->view(), car_, beamsTo({{19.975, 2.8}, {19.975, 3.1}}));
  EXPECT_EQ(match.beams, 2);
  EXPECT_EQ(match.inlier_ratio, 0.5);
  EXPECT_EQ(match.obstructed + match.contradicted + match.unmapped, 0.0);
}

TEST_F(ScanMatchEvaluatorTest, IsIndependentOfEarlierScans) {
  const std::vector<std::vector<Eigen::Vector2d>> scans{
      {{10.0, 0.025}, {10.0, -0.6}, {5.0, 3.0}}, {{10.0, 0.3}}, {{5.0, 3.0}, {10.0, 0.025}}};
  for (const std::vector<Eigen::Vector2d>& ends : scans) {
    EXPECT_EQ(match(ends), ScanMatchEvaluator().classifyBeams(map_->view(), car_, beamsTo(ends)));
  }
}

}  // namespace
}  // namespace racecar_mcl
