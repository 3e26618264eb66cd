#include "racecar_mcl/obstacles/obstacle_detection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/localization_map.h"

namespace racecar_mcl {
namespace {

constexpr double kResolution = 0.05;  // m

/// 10 x 6 m of free space between walls of one cell, with another wall from (6, 0) to (6, 4) and
/// unknown cells from x = 9 m on.
OccupancyGrid twoRooms() {
  constexpr int kColumns = 200, kRows = 120;
  std::vector<std::int8_t> cells;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const bool is_outer = row == 0 || row == kRows - 1 || column == 0 || column == kColumns - 1;
      const bool is_inner = column == 120 && row < 80;
      const bool is_unknown = column >= 180;
      cells.push_back(is_outer || is_inner ? OccupancyGrid::kOccupied
                      : is_unknown         ? OccupancyGrid::kUnknown
                                           : OccupancyGrid::kFree);
    }
  }
  return OccupancyGrid({kColumns, kRows, kResolution, {}}, std::move(cells));
}

/// The car is at (2, 3) with the lidar 0.3 m ahead; beams are given by their end points on the map.
class ObstacleDetectionTest : public ::testing::Test {
 protected:
  DetectedObstacles detect(const std::vector<Eigen::Vector2d>& ends) {
    return ObstacleDetector(parameters_).detect(map_->view(), estimate_, scanOf(ends));
  }

  Scan scanOf(const std::vector<Eigen::Vector2d>& ends) const {
    const auto count = static_cast<Eigen::Index>(ends.size());
    Scan scan;
    scan.laser_in_base = {0.3, 0.0, 0.0};
    scan.bearings.resize(count);
    scan.ranges.resize(count);
    scan.seconds_after_stamp = Eigen::ArrayXf::Zero(count);
    const Pose2 lidar = compose(estimate_.base_in_map, scan.laser_in_base);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Eigen::Vector2d end = ends[static_cast<std::size_t>(k)];
      const Pose2 in_lidar = between(lidar, {end.x(), end.y(), 0.0});
      scan.bearings[k] = static_cast<float>(std::atan2(in_lidar.y, in_lidar.x));
      scan.ranges[k] = static_cast<float>(std::hypot(in_lidar.x, in_lidar.y));
    }
    return scan;
  }

  /// Five returns, 0.05 m apart in y, around a point.
  static std::vector<Eigen::Vector2d> faceAt(double x, double y) {
    std::vector<Eigen::Vector2d> face;
    for (int k = -2; k <= 2; ++k) face.emplace_back(x, y + 0.05 * k);
    return face;
  }

  ObstacleDetectionParameters parameters_;
  PoseEstimate estimate_{{2.0, 3.0, 0.0}, Eigen::Matrix3d::Zero()};
  std::shared_ptr<const LocalizationMap> map_ = makeLocalizationMap(twoRooms(), SensorParameters{});
};

TEST_F(ObstacleDetectionTest, FindsReturnsInFreeSpace) {
  const DetectedObstacles found = detect(faceAt(4.0, 3.0));
  ASSERT_EQ(found.clusters.size(), 1u);
  EXPECT_EQ(found.points_in_map.cols(), 5);
  EXPECT_NEAR(found.points_in_map.row(0).mean(), 4.0, 1e-5);
  EXPECT_NEAR(found.points_in_map.row(1).mean(), 3.0, 1e-5);
  const ObstacleCluster& cluster = found.clusters.front();
  EXPECT_EQ(cluster.returns, 5);
  EXPECT_NEAR(cluster.position_in_map.x(), 4.2, 0.01) << "behind the returns";
  EXPECT_NEAR(cluster.position_in_map.y(), 3.0, 0.01);
  EXPECT_NEAR(cluster.extent, 0.2, 1e-4);
}

TEST_F(ObstacleDetectionTest, FindsNothingAtTheWalls) {
  std::vector<Eigen::Vector2d> ends = faceAt(6.0, 3.0);
  for (const Eigen::Vector2d& end : faceAt(6.02, 2.0)) ends.push_back(end);
  for (const Eigen::Vector2d& end : faceAt(5.97, 1.0)) ends.push_back(end);
  EXPECT_TRUE(detect(ends).clusters.empty());
}

TEST_F(ObstacleDetectionTest, SeparatesAnObstacleFromTheWallBehindIt) {
  // Distances are from the centres of the wall's cells, at x = 6.025 m.
  EXPECT_EQ(detect(faceAt(5.94, 3.0)).clusters.size(), 1u);
  EXPECT_TRUE(detect(faceAt(5.98, 3.0)).clusters.empty());
  parameters_.obstacle_distance = 0.12;
  EXPECT_TRUE(detect(faceAt(5.94, 3.0)).clusters.empty());
}

TEST_F(ObstacleDetectionTest, AllowsForTheUncertaintyOfThePose) {
  const std::vector<Eigen::Vector2d> ends = faceAt(5.8, 3.0);
  EXPECT_EQ(detect(ends).clusters.size(), 1u);
  estimate_.covariance(0, 0) = 0.08 * 0.08;
  EXPECT_TRUE(detect(ends).clusters.empty());
  // 0.03 rad displace returns 3.8 m away by 0.11 m.
  estimate_.covariance = Eigen::Vector3d(0.0, 0.0, 0.03 * 0.03).asDiagonal();
  EXPECT_TRUE(detect(ends).clusters.empty());
  const DetectedObstacles found = detect(faceAt(4.0, 3.0));
  ASSERT_EQ(found.clusters.size(), 1u);
  EXPECT_NEAR(std::sqrt(found.clusters.front().covariance(1, 1)), 0.03 * 2.2, 1e-3);
}

TEST_F(ObstacleDetectionTest, FindsNothingBehindWallsOrInUnknownSpace) {
  EXPECT_TRUE(detect(faceAt(6.4, 2.0)).clusters.empty()) << "behind the inner wall";
  EXPECT_TRUE(detect(faceAt(8.0, 2.0)).clusters.empty()) << "far behind it";
  EXPECT_EQ(detect(faceAt(8.0, 4.9)).clusters.size(), 1u) << "beside it";
  EXPECT_TRUE(detect(faceAt(9.5, 5.0)).clusters.empty()) << "unknown";
}

TEST_F(ObstacleDetectionTest, DropsClustersOfFewReturns) {
  const std::vector<Eigen::Vector2d> two{{4.0, 3.0}, {4.0, 3.05}};
  EXPECT_TRUE(detect(two).clusters.empty());
  EXPECT_EQ(detect(two).points_in_map.cols(), 0);
  parameters_.obstacle_min_returns = 2;
  EXPECT_EQ(detect(two).clusters.size(), 1u);
}

TEST_F(ObstacleDetectionTest, SeparatesObstaclesByGapsInAnyOrderOfBeams) {
  std::vector<Eigen::Vector2d> ends = faceAt(4.0, 3.0);
  for (const Eigen::Vector2d& end : faceAt(4.0, 3.5)) ends.push_back(end);
  EXPECT_EQ(detect(ends).clusters.size(), 2u) << "0.3 m apart";
  ends.emplace_back(4.0, 3.25);
  EXPECT_EQ(detect(ends).clusters.size(), 1u) << "linked";
  EXPECT_NEAR(detect(ends).clusters.front().extent, 0.7, 1e-4);
}

TEST_F(ObstacleDetectionTest, IgnoresBeamsWithoutAReturn) {
  Scan scan = scanOf(faceAt(4.0, 3.0));
  scan.ranges.head(3).setConstant(std::numeric_limits<float>::infinity());
  estimate_.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  EXPECT_TRUE(ObstacleDetector(parameters_).detect(map_->view(), estimate_, scan).clusters.empty());
}

TEST(ObstacleDetectionParameters, AreChecked) {
  EXPECT_THROW(ObstacleDetector({-0.1, 3}), ParameterError);
  EXPECT_THROW(ObstacleDetector({std::numeric_limits<double>::quiet_NaN(), 3}), ParameterError);
  EXPECT_THROW(ObstacleDetector({0.1, 0}), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl
