#include "sim/simulator.h"

#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "support/ascii_map.h"

namespace racecar_mcl::sim {
namespace {

std::shared_ptr<const World> room() {
  return std::make_shared<const World>(asciiMap(R"(
      ##########
      #........#
      #........#
      #........#
      #........#
      ##########)"));
}

const Pose2 kStart{3.0, 3.0, 0.3};

/// All values of an event.
std::vector<double> numbers(const std::vector<Event>& events) {
  std::vector<double> all;
  const auto add = [&](double stamp, const Pose2& pose, const Twist2& twist) {
    all.insert(all.end(), {stamp, pose.x, pose.y, pose.yaw, twist.vx, twist.vy, twist.wz});
  };
  for (const Event& event : events) {
    all.push_back(event.arrival);
    if (const auto* sweep = std::get_if<LidarScan>(&event.data)) {
      all.insert(all.end(), sweep->ranges.begin(), sweep->ranges.end());
    } else if (const auto* sample = std::get_if<OdometrySample>(&event.data)) {
      add(sample->stamp, sample->base_in_odom, sample->twist);
    } else if (const auto* gyro = std::get_if<GyroSample>(&event.data)) {
      all.insert(all.end(), {gyro->stamp, gyro->yaw_rate});
    } else {
      const Truth& truth = std::get<Truth>(event.data);
      add(truth.stamp, truth.base_in_map, truth.twist);
    }
  }
  return all;
}

std::vector<Event> run(std::uint64_t seed, double step,
                       const SimulatorParameters& parameters = {}) {
  Simulator simulator(room(), parameters, kStart, seed, 1000.0);
  std::vector<Event> events;
  for (int i = 0; i < std::lround(1.0 / step); ++i) {
    for (Event& event : simulator.advance(step, {1.0, -0.1})) events.push_back(std::move(event));
  }
  return events;
}

template <typename Kind>
std::vector<Kind> only(const std::vector<Event>& events) {
  std::vector<Kind> found;
  for (const Event& event : events) {
    if (const auto* data = std::get_if<Kind>(&event.data)) found.push_back(*data);
  }
  return found;
}

TEST(Simulator, SameSeedSameBits) {
  EXPECT_EQ(numbers(run(5, 0.01)), numbers(run(5, 0.01)));
  EXPECT_NE(numbers(run(5, 0.01)), numbers(run(6, 0.01)));
}

TEST(Simulator, TheSizeOfTheStepsChangesNothing) {
  EXPECT_EQ(numbers(run(5, 0.0025)), numbers(run(5, 0.2)));
}

TEST(Simulator, OdometryNoiseLeavesTruthAndScansAlone) {
  SimulatorParameters noisy;
  noisy.odometry.noise = {1.0, 1.0, 1.0};
  const auto a = run(5, 0.01);
  const auto b = run(5, 0.01, noisy);
  ASSERT_EQ(only<LidarScan>(a).size(), only<LidarScan>(b).size());
  EXPECT_EQ(only<LidarScan>(a).back().ranges, only<LidarScan>(b).back().ranges);
  EXPECT_EQ(only<Truth>(a).back().base_in_map.x, only<Truth>(b).back().base_in_map.x);
  EXPECT_NE(only<OdometrySample>(a).back().twist.vx, only<OdometrySample>(b).back().twist.vx);
}

TEST(Simulator, EventsComeInTheOrderOfTheirArrivalAtTheirRates) {
  const auto events = run(5, 0.01);
  for (std::size_t i = 1; i < events.size(); ++i) {
    EXPECT_LE(events[i - 1].arrival, events[i].arrival);
  }
  EXPECT_EQ(only<LidarScan>(events).size(), 40u);
  EXPECT_EQ(only<OdometrySample>(events).size(), 50u);
  EXPECT_EQ(only<Truth>(events).size(), 100u);
  EXPECT_NEAR(only<LidarScan>(events)[3].stamp, 1000.075, 1e-9);
  EXPECT_NEAR(only<LidarScan>(events)[3].arrival, 1000.09375, 1e-9);
}

TEST(Simulator, ARearLidarFacesBackAndLeavesTheOtherSensorsAlone) {
  SimulatorParameters two;
  two.rear_lidar.enabled = true;
  two.rear_lidar.range_bias = 0.5;
  std::vector<LidarScan> front, rear;
  for (const LidarScan& scan : only<LidarScan>(run(5, 0.01, two))) {
    (scan.lidar == 0 ? front : rear).push_back(scan);
  }
  const auto alone = only<LidarScan>(run(5, 0.01));
  ASSERT_EQ(front.size(), alone.size());
  EXPECT_EQ(front.back().ranges, alone.back().ranges);
  ASSERT_EQ(rear.size(), 39u);
  EXPECT_EQ(rear[0].laser_in_base.yaw, kPi);
  EXPECT_NEAR(rear[0].stamp, 1000.01, 1e-9);
  EXPECT_EQ(toScan(rear[0]).lidar, 1);
  // Walls 8 m apart, measured in opposite directions on one line.
  const double behind = static_cast<double>(rear[0].ranges[540]);
  const double ahead = static_cast<double>(front[0].ranges[540]);
  const double room = 8.0 / std::cos(kStart.yaw);
  EXPECT_NEAR(ahead + 0.27 + behind + 0.1, room + 0.5, 0.1);
}

TEST(Simulator, TruthIsWhereTheCarWasAtTheStamp) {
  SimulatorParameters parameters;
  parameters.truth_rate = 97.0;  // not a multiple of the simulation step
  const auto truths = only<Truth>(run(5, 0.01, parameters));
  for (std::size_t i = 1; i < truths.size(); ++i) {
    const Pose2 step = between(truths[i - 1].base_in_map, truths[i].base_in_map);
    const double seconds = truths[i].stamp - truths[i - 1].stamp;
    const double mean = (truths[i].twist.vx + truths[i - 1].twist.vx) / 2.0;
    EXPECT_NEAR(std::hypot(step.x, step.y), mean * seconds, 1e-4);
  }
}

TEST(Simulator, ParametersChangeWhileItRuns) {
  Simulator simulator(room(), {}, kStart, 5);
  simulator.advance(0.5, {});
  SimulatorParameters parameters = simulator.parameters();
  parameters.lidar.beams = 361;
  parameters.lidar.rate = 20.0;
  parameters.odometry.rate = 100.0;
  simulator.setParameters(parameters);
  const auto events = simulator.advance(1.0, {});
  EXPECT_EQ(only<LidarScan>(events).back().ranges.size(), 361u);
  EXPECT_NEAR(static_cast<double>(only<LidarScan>(events).size()), 20.0, 1.0);
  EXPECT_NEAR(static_cast<double>(only<OdometrySample>(events).size()), 100.0, 1.0);
  parameters.lidar.beams = 0;
  EXPECT_THROW(simulator.setParameters(parameters), ParameterError);
  EXPECT_EQ(simulator.parameters().lidar.beams, 361);
}

TEST(Simulator, ThePlacedCarStandsThereAndItsOdometryNoticesNothing) {
  SimulatorParameters parameters;
  parameters.odometry.noise = {0.0, 0.0, 0.0};
  Simulator simulator(room(), parameters, kStart, 5);
  simulator.advance(1.0, {1.0, 0.0});
  const Pose2 before =
      only<OdometrySample>(simulator.advance(0.02, {0.0, 0.0})).back().base_in_odom;
  simulator.place({8.0, 2.0, -1.0});
  EXPECT_EQ(simulator.truth().base_in_map.x, 8.0);
  EXPECT_EQ(simulator.truth().twist.vx, 0.0);
  const Pose2 after = only<OdometrySample>(simulator.advance(0.1, {})).back().base_in_odom;
  EXPECT_LT(distance(before, after), 0.05);
  EXPECT_THROW(simulator.place({std::nan(""), 0.0, 0.0}), ParameterError);
}

TEST(Simulator, ObstaclesComeAndGo) {
  SimulatorParameters parameters;
  parameters.lidar.range_noise = 0.0;
  parameters.lidar.missing_rate = 0.0;
  Simulator simulator(room(), parameters, {3.0, 3.0, 0.0}, 5);
  Obstacle disc;
  disc.in_map = {6.0, 3.0, 0.0};
  simulator.setObstacles({disc});
  EXPECT_NEAR(only<LidarScan>(simulator.advance(0.024, {})).at(0).ranges[540], 2.58, 1e-6);
  simulator.setObstacles({});
  EXPECT_NEAR(only<LidarScan>(simulator.advance(0.025, {})).at(0).ranges[540], 5.73, 1e-6);
  disc.radius = -1.0;
  EXPECT_THROW(simulator.setObstacles({disc}), ParameterError);
}

TEST(Simulator, LookingSeesWithoutFaultsAndChangesNothing) {
  SimulatorParameters blind;
  blind.lidar.missing_rate = 1.0;
  blind.lidar.range_noise = 1.0;
  Simulator looked(room(), blind, {3.0, 3.0, 0.0}, 5);
  EXPECT_NEAR(looked.look().ranges[270], 5.73, 1e-6);
  Simulator left_alone(room(), blind, {3.0, 3.0, 0.0}, 5);
  EXPECT_EQ(numbers(looked.advance(0.1, {})), numbers(left_alone.advance(0.1, {})));
}

TEST(Simulator, TheLidarSeesThroughTheUnknownThatADriverTakesForAWall) {
  const auto world = std::make_shared<const World>(asciiMap("......??#"));
  SimulatorParameters exact;
  exact.lidar.range_noise = 0.0;
  exact.lidar.missing_rate = 0.0;
  Simulator simulator(world, exact, {3.0, 0.5, 0.0}, 5);
  EXPECT_NEAR(simulator.look().ranges[270], 6.0 - 3.27, 1e-6);
  const LidarScan seen = only<LidarScan>(simulator.advance(0.024, {})).at(0);
  EXPECT_NEAR(seen.ranges[540], 8.0 - 3.27, 1e-6);
  EXPECT_EQ(seen.ranges[0], HUGE_VALF);  // leaves the map
}

TEST(Simulator, RefusesCommandsThatAreNoNumbers) {
  Simulator simulator(room(), {}, kStart, 5);
  EXPECT_THROW(simulator.advance(0.1, {std::nan(""), 0.0}), ParameterError);
  EXPECT_THROW(simulator.advance(-0.1, {}), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl::sim
