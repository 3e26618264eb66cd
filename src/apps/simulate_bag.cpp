// Simulates a wall-following car and records its sensors in a bag.
#include <unistd.h>

#include <cstdio>

#include "cli.h"
#include "file_options.h"
#include "offline/simulation_recorder.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/map/map_io.h"
#include "ros/localization/node_parameters.h"
#include "sim/driver.h"
#include "sim/lap_counter.h"
#include "sim/scenario.h"
#include "sim/simulator.h"

namespace racecar_mcl {
namespace {

constexpr double kStartTime = 1000.0;  // s; ROS treats 0 as unset
constexpr double kMaxLapTime = 300.0;  // s

struct Options {
  std::string bag;
  std::string truth;
  std::string start;
  double duration = 0.0;  // s; 0 = not set
  int laps = 0;           // 0 = not set
  std::uint64_t seed = 1;
  double odometry_noise = sim::OdometryParameters().noise.vx;
  bool follow_right = false;
  sim::ScenarioParameters scenario;
  sim::SimulatorParameters simulator;
  sim::WallFollowerParameters follower;
};

void addOptions(Options* o, CLI::App* app) {
  sim::OdometryParameters& odometry = o->simulator.odometry;
  sim::LidarParameters& lidar = o->simulator.lidar;
  const auto option = [app](const char* name, auto& value, const char* description) {
    app->add_option(name, value, description)->capture_default_str();
  };
  app->add_option("--map", o->scenario.map, "map YAML file")->required();
  app->add_option("--world", o->scenario.world, "world YAML file [<map>_world.yaml, else the map]");
  app->add_option("--out", o->bag, "output bag")->required();
  app->add_option("--truth", o->truth, "output TUM file with the true poses of base_link in map");
  app->add_option("--start", o->start, "start pose \"x y yaw\" [<map>_start.yaml, else random]");
  app->add_option("--duration", o->duration, "duration, s [60, or unlimited with --laps]");
  app->add_option("--laps", o->laps, "number of laps");
  option("--seed", o->seed, "random seed");

  option("--speed", o->follower.speed, "maximum speed, m/s");
  option("--wall-distance", o->follower.wall_distance, "distance to the followed wall, m");
  app->add_flag("--right", o->follow_right, "follow the right wall instead of the left");

  option("--odom-noise", o->odometry_noise, "standard deviation of vx, vy (m/s) and wz (rad/s)");
  option("--speed-scale-error", odometry.speed_scale_error,
         "scale error of the speed; 0.02 = 2 % too fast");
  option("--turn-scale-error", odometry.rotation_scale_error, "scale error of the turn rate");
  option("--speed-bias", odometry.speed_bias, "bias of the speed, m/s");
  option("--turn-bias", odometry.turn_bias, "bias of the turn rate, rad/s");
  option("--slip", odometry.slip, "wheel slip during bursts; 0.15 = 15 % too fast or slow");
  option("--slip-rate", odometry.slip_rate, "slip bursts per second");
  option("--slip-duration", odometry.slip_duration, "mean duration of a slip burst, s");
  option("--dropout", odometry.dropout_rate, "fraction of lost odometry messages");

  option("--odom-turn-delay", odometry.turn_delay, "delay of the turn rate, s");
  app->add_flag("--odom-turn-from-command", odometry.turn_from_command,
                "turn rate from the commanded steering angle, as the VESC's odometry");
  option("--steering-delay", o->simulator.car.steering_delay,
         "delay from a steering command to its beginning, s");

  sim::GyroParameters& gyro = o->simulator.gyro;
  app->add_flag("--imu", gyro.enabled, "record the gyro, on /imu");
  option("--gyro-noise", gyro.noise, "standard deviation of the yaw rate, rad/s");
  option("--gyro-bias", gyro.bias, "bias of the yaw rate, rad/s");
  option("--gyro-scale-error", gyro.scale_error, "scale error of the yaw rate");
  option("--gyro-delay", gyro.delay, "delay of the yaw rate, s");
  app->add_flag("--gyro-in-degrees", gyro.in_degrees, "yaw rate in degrees per second");

  option("--range-noise", lidar.range_noise, "standard deviation of ranges, m");
  option("--range-bias", lidar.range_bias, "added to every range, m");
  option("--missing-rate", lidar.missing_rate, "fraction of beams without return");
  option("--scan-dropout", lidar.dropout_rate, "fraction of lost scans");
  option("--max-range", lidar.range_max, "maximum range, m");
  app->add_flag("--instant-scans", lidar.instant,
                "measure all beams at once, without motion distortion");
  app->add_flag("--clockwise", lidar.clockwise,
                "clockwise lidar: beams in reverse acquisition order");
  option("--glass", lidar.glass.share, "fraction of walls without returns (glass)");

  sim::RearLidarParameters& rear = o->simulator.rear_lidar;
  app->add_flag("--rear-lidar", rear.enabled, "record a lidar that faces back, on /scan_rear");
  option("--rear-range-bias", rear.range_bias, "added to its ranges, m");
  app->add_flag("--rear-clockwise", rear.clockwise, "it is clockwise");

  option("--obstacles", o->scenario.obstacles, "number of unmapped obstacles");
  option("--moving-obstacles", o->scenario.moving_obstacles, "number of them that move");
}

void validate(Options& o) {
  requireNotNegative("--duration", o.duration, "s");
  requireNotNegative("--laps", o.laps);
  std::vector<std::string> inputs = mapFiles(o.scenario.map);
  for (const std::string& file :
       mapFiles(o.scenario.world.empty() ? sim::worldPathFor(o.scenario.map) : o.scenario.world)) {
    inputs.push_back(file);
  }
  requireSeparateFiles({o.bag, o.truth}, inputs);
  if (o.laps == 0 && o.duration == 0.0) o.duration = 60.0;
  o.simulator.odometry.noise = {o.odometry_noise, o.odometry_noise, o.odometry_noise};
  o.simulator.validate();
  if (!o.start.empty()) o.scenario.start = parsePose("--start", o.start);
  o.scenario.seed = o.seed;
  o.scenario.car = o.simulator.car;
  o.follower.side = o.follow_right ? sim::Side::kRight : sim::Side::kLeft;
  o.follower.car = o.simulator.car;
  o.follower.validate();
}

struct Drive {
  int laps = 0;
  double seconds = 0.0;
  double distance = 0.0;   // m
  double top_speed = 0.0;  // m/s
};

void showProgress(const Options& o, const Drive& drive) {
  double progress = 0.0;
  if (o.duration > 0.0) progress = drive.seconds / o.duration;
  if (o.laps > 0) progress = std::max(progress, static_cast<double>(drive.laps) / o.laps);
  std::fprintf(stderr, "\r%3.0f %%  %.0f s driven, lap %d ", 100.0 * progress, drive.seconds,
               drive.laps + 1);
}

Drive driveAndRecord(const Options& o, sim::Simulator& simulator, SimulationRecorder& recorder) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  sim::Driver driver(o.follower);
  sim::LapCounter laps(simulator.truth().base_in_map);
  Drive drive;
  double lap_start = 0.0;
  for (long steps = 1;; ++steps) {
    const sim::Truth before = simulator.truth();
    const sim::Command command =
        driver.drive(simulator.look(), before.twist.vx, simulator.collided());
    for (const sim::Event& event : simulator.advance(sim::kControlPeriod, command)) {
      recorder.write(event);
    }
    const sim::Truth truth = simulator.truth();
    laps.update(truth.base_in_map);
    drive.seconds = truth.stamp - kStartTime;
    drive.distance += distance(before.base_in_map, truth.base_in_map);
    drive.top_speed = std::max(drive.top_speed, truth.twist.vx);
    if (laps.laps() > drive.laps) lap_start = drive.seconds;
    drive.laps = laps.laps();
    if (terminal && steps % 50 == 0) showProgress(o, drive);
    const bool time_is_up =
        o.duration > 0.0 && drive.seconds >= o.duration - sim::kControlPeriod / 2.0;
    if (time_is_up || (o.laps > 0 && drive.laps >= o.laps)) break;
    if (o.duration == 0.0 && drive.seconds - lap_start > kMaxLapTime) {
      throw std::runtime_error("lap " + std::to_string(drive.laps + 1) +
                               " was not completed within " +
                               std::to_string(static_cast<int>(kMaxLapTime)) +
                               " s; use --duration instead of --laps if the course has no loop");
    }
  }
  if (terminal) std::fprintf(stderr, "\r%40s\r", "");
  return drive;
}

void run(Options o) {
  validate(o);
  const sim::Scenario scenario = sim::loadScenario(o.scenario);
  const Pose2& start = scenario.start_in_map;
  sim::Simulator simulator(scenario.world, o.simulator, start, o.seed, kStartTime);
  simulator.setObstacles(scenario.obstacles);

  SimulationRecorder recorder(o.bag, o.truth, o.simulator, kStartTime);
  const Drive drive = driveAndRecord(o, simulator, recorder);
  recorder.commit();
  std::printf("%s: %.1f s in %s from (%.3f, %.3f, %.3f)\n", o.bag.c_str(), drive.seconds,
              scenario.world_path.c_str(), start.x, start.y, start.yaw);
  std::printf("laps %d, distance %.1f m, mean %.2f m/s, max %.2f m/s, collisions %d\n", drive.laps,
              drive.distance, drive.distance / drive.seconds, drive.top_speed,
              simulator.collisions());
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "simulate_bag",
      "Simulates a wall-following racecar and records its sensors in a bag.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
