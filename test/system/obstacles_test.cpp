// Obstacles found on simulated drives, as in bench/obstacles_benchmark.cpp.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "offline/obstacle_drive.h"

namespace racecar_mcl {
namespace {

constexpr std::uint64_t kSeeds = 3;

class ObstaclesTest : public ::testing::TestWithParam<const char*> {
 protected:
  static ObstacleScore scoreOf(ObstacleDrive drive) {
    drive.map = std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml";
    ObstacleScore score;
    for (drive.seed = 1; drive.seed <= kSeeds; ++drive.seed) score += driveOnce(drive);
    return score;
  }
};

TEST_P(ObstaclesTest, FindsNearlyAllInView) {
  ObstacleDrive drive;
  drive.seconds = 5.0;
  for (const Fault traffic : {Fault::kObstacles, Fault::kCrowd}) {
    drive.traffic = traffic;
    const ObstacleScore score = scoreOf(drive);
    EXPECT_GT(score.visible, 200);
    EXPECT_GT(score.recall(), 0.95);
    EXPECT_LE(score.false_clusters, 1);
  }
}

TEST_P(ObstaclesTest, FindsNoneOnALapWithoutObstacles) {
  ObstacleDrive drive;
  drive.seconds = 25.0;  // laps take 24 to 25 s
  const ObstacleScore score = scoreOf(drive);
  EXPECT_EQ(score.scans, 3000);
  EXPECT_LT(score.clusters, 3);
}

TEST_P(ObstaclesTest, MeasuresTheVelocityOfACarAhead) {
  ObstacleDrive drive;
  drive.has_car_ahead = true;
  drive.seconds = 20.0;
  const ObstacleScore score = scoreOf(drive);
  EXPECT_GT(score.velocities, 2000);
  EXPECT_LT(score.velocityRms(), 0.3);
}

TEST_P(ObstaclesTest, FindsNoneInAWingThatTheMapLacks) {
  ObstacleDrive drive;
  drive.map_fault = "erased_wing";
  drive.seconds = 8.0;
  EXPECT_LT(scoreOf(drive).clusters, 3);
}

INSTANTIATE_TEST_SUITE_P(Maps, ObstaclesTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
