// Long drives of the wall follower on both maps.
#include <gtest/gtest.h>

#include "racecar_mcl/map/map_io.h"
#include "sim/lap_counter.h"
#include "sim/scenario.h"
#include "sim/simulator.h"
#include "sim/wall_follower.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kSeconds = 600.0;

class FollowerEnduranceTest : public testing::TestWithParam<const char*> {};

TEST_P(FollowerEnduranceTest, DrivesTenMinutesWithoutACollision) {
  ScenarioParameters place;
  place.map = std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml";
  const Scenario scenario = loadScenario(place);
  SimulatorParameters parameters;
  // The follower uses Simulator::look; these sweeps are not used.
  parameters.lidar.rate = 1.0;
  parameters.lidar.sweep_time = 0.0;
  parameters.lidar.beams = 2;
  Simulator simulator(scenario.world, parameters, scenario.start_in_map, 1);
  const WallFollower follower(WallFollowerParameters{});
  LapCounter laps(scenario.start_in_map);
  double distance_driven = 0.0;
  while (simulator.time() < kSeconds) {
    const Truth before = simulator.truth();
    simulator.advance(kControlPeriod, follower.follow(simulator.look(), before.twist.vx));
    const Pose2 now = simulator.truth().base_in_map;
    laps.update(now);
    distance_driven += distance(before.base_in_map, now);
    ASSERT_EQ(simulator.collisions(), 0)
        << "at (" << now.x << ", " << now.y << ") after " << simulator.time() << " s";
  }
  std::printf("%s: %d laps, %.0f m, mean %.2f m/s\n", GetParam(), laps.laps(), distance_driven,
              distance_driven / kSeconds);
  EXPECT_GE(laps.laps(), 20);
}

INSTANTIATE_TEST_SUITE_P(Maps, FollowerEnduranceTest, testing::Values("corridor", "track"));

}  // namespace
}  // namespace racecar_mcl::sim
