// Laps driven on the estimate, as in evaluate_race, compared with laps on the true pose.
#include <gtest/gtest.h>

#include <string>

#include "offline/race_drive.h"

namespace racecar_mcl {
namespace {

RaceTrack trackOf(const std::string& map) {
  return loadRaceTrack(RACECAR_MCL_SOURCE_DIR "/maps/" + map + ".yaml", {});
}

RaceSettings lowGrip(int laps) {
  RaceSettings settings;
  settings.grip = kLowGrip;
  settings.laps = laps;
  return settings;
}

class RaceTest : public ::testing::TestWithParam<const char*> {
 protected:
  void expectAsOnTheTruth(const RaceSettings& settings) const {
    const RaceScore truth = raceOnTruth(track_, settings);
    EXPECT_EQ(truth.collisions, 0);
    EXPECT_NEAR(truth.along.max(), 0.0, 1e-9);
    EXPECT_NEAR(truth.across.max(), 0.0, 1e-9);
    const RaceScore estimate = raceOnEstimate(track_, {}, settings);
    EXPECT_EQ(estimate.lap_times.size(), static_cast<std::size_t>(settings.laps));
    EXPECT_EQ(estimate.collisions, 0);
    EXPECT_GT(estimate.max_speed, 7.5);
    EXPECT_LT(estimate.lateral.mean(), truth.lateral.mean() + 0.01);
    EXPECT_LT(estimate.along.mean(), 0.02);
    EXPECT_LT(estimate.across.mean(), 0.01);
    EXPECT_GT(estimate.shareLocalized(), 0.95);
    EXPECT_LE(estimate.shareBeyondLevel(), 0.001);
    EXPECT_GT(estimate.shareAtBounds(), 0.98);
    EXPECT_NEAR(estimate.meanLapTime(), truth.meanLapTime(), 0.1);
  }

  const RaceTrack track_ = trackOf(GetParam());
};

TEST_P(RaceTest, IsDrivenOnTheEstimateAsOnTheTruth) { expectAsOnTheTruth(lowGrip(2)); }

TEST_P(RaceTest, IsDrivenBesideAnOpponent) {
  RaceSettings settings = lowGrip(1);
  settings.has_opponent = true;
  expectAsOnTheTruth(settings);
}

TEST(RaceOnEstimate, RepeatsForASeed) {
  const RaceTrack track = trackOf("corridor");
  const RaceSettings settings = lowGrip(1);
  const RaceScore first = raceOnEstimate(track, {}, settings);
  const RaceScore second = raceOnEstimate(track, {}, settings);
  EXPECT_EQ(first.lap_times, second.lap_times);
  EXPECT_EQ(first.lateral.mean(), second.lateral.mean());
}

INSTANTIATE_TEST_SUITE_P(Maps, RaceTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
