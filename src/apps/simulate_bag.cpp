// Drives the simulated car along a wall and writes what it senses into a bag: rosrun racecar_mcl
// simulate_bag.
#include <unistd.h>

#include <cstdio>

#include "apps/simulate_bag_recording.h"
#include "program.h"
#include "racecar_mcl/errors.h"
#include "racecar_mcl/require.h"
#include "ros/node_parameters.h"
#include "sim/driver.h"
#include "sim/lap_counter.h"
#include "sim/scene.h"
#include "sim/simulator.h"

namespace racecar_mcl {
namespace {

constexpr double kStartTime = 1000.0;   // s; ROS takes 0 for no time at all
constexpr double kDriverPeriod = 0.02;  // s, between the driver's looks
constexpr double kLongestLap = 300.0;   // s, after which a lap is given up

struct Options {
  std::string bag;
  std::string truth;
  std::string start;
  double duration = 0.0;  // s; 0 = not given
  int laps = 0;           // 0 = not given
  std::uint64_t seed = 1;
  double odometry_noise = sim::OdometryParameters().noise.vx;
  bool follow_right = false;
  sim::SceneParameters scene;
  sim::SimulatorParameters simulator;
  sim::WallFollowerParameters follower;
};

void addOptions(Options* o, CLI::App* app) {
  sim::OdometryParameters& odometry = o->simulator.odometry;
  sim::LidarParameters& lidar = o->simulator.lidar;
  const auto option = [app](const char* name, auto& value, const char* description) {
    app->add_option(name, value, description)->capture_default_str();
  };
  app->add_option("--map", o->scene.map, "map_server YAML of the map")->required();
  app->add_option("--world", o->scene.world,
                  "YAML of the finer world [<map>_world.yaml, else the map]");
  app->add_option("--out", o->bag, "the bag to write")->required();
  app->add_option("--truth", o->truth, "TUM file for the true poses of base_link in map");
  app->add_option("--start", o->start, "\"x y yaw\" in map [<map>_start.yaml, else random]");
  app->add_option("--duration", o->duration, "s to drive [60; with --laps no limit but the laps]");
  app->add_option("--laps", o->laps, "stop after so many laps");
  option("--seed", o->seed, "same seed, same bag");

  option("--speed", o->follower.speed, "m/s where the way is straight");
  option("--wall-distance", o->follower.wall_distance, "m from the wall followed");
  app->add_flag("--right", o->follow_right, "follow the right wall instead of the left one");

  option("--odom-noise", o->odometry_noise, "sigma on vx, vy (m/s) and wz (rad/s)");
  option("--speed-scale-error", odometry.speed_scale_error, "0.02: 2 % too fast");
  option("--turn-scale-error", odometry.turn_scale_error, "0.03: 3 % too much");
  option("--speed-bias", odometry.speed_bias, "m/s");
  option("--turn-bias", odometry.turn_bias, "rad/s");
  option("--slip", odometry.slip, "0.15: wheels 15 % too fast or slow in bursts");
  option("--slip-rate", odometry.slip_rate, "bursts per second");
  option("--slip-duration", odometry.slip_duration, "s, mean length of a burst");
  option("--dropout", odometry.dropout_rate, "share of odometry messages lost");

  option("--range-noise", lidar.range_noise, "m, sigma");
  option("--missing-rate", lidar.missing_rate, "share of beams without return");
  option("--scan-dropout", lidar.dropout_rate, "share of scans lost");
  option("--max-range", lidar.range_max, "m");
  app->add_flag("--instant-scans", lidar.instant, "all beams at once: no distortion");
  app->add_flag("--clockwise", lidar.clockwise,
                "a lidar that turns clockwise, its beams listed against the time");
  option("--glass", lidar.glass.share, "share of the walls that return nothing");
  option("--obstacles", o->scene.obstacles, "unmapped things beside the walls");
  option("--moving-obstacles", o->scene.moving_obstacles, "how many of them walk");
}

void validate(Options& o) {
  requireNotNegative("--duration", o.duration, "s");
  requireNotNegative("--laps", o.laps);
  if (o.truth == o.bag) throw ParameterError("--out and --truth both name " + o.bag);
  if (o.laps == 0 && o.duration == 0.0) o.duration = 60.0;
  o.simulator.odometry.noise = {o.odometry_noise, o.odometry_noise, o.odometry_noise};
  o.simulator.validate();
  if (!o.start.empty()) o.scene.start = parsePose("--start", o.start);
  o.scene.seed = o.seed;
  o.scene.car = o.simulator.car;
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
  double share = 0.0;
  if (o.duration > 0.0) share = drive.seconds / o.duration;
  if (o.laps > 0) share = std::max(share, static_cast<double>(drive.laps) / o.laps);
  std::fprintf(stderr, "\r%3.0f %%  %.0f s driven, lap %d ", 100.0 * share, drive.seconds,
               drive.laps + 1);
}

Drive driveAndRecord(const Options& o, sim::Simulator& simulator, Recording& recording) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  sim::Driver driver(o.follower);
  sim::LapCounter laps(simulator.truth().base_in_map);
  Drive drive;
  double lap_began = 0.0;
  for (long steps = 1;; ++steps) {
    const sim::Truth before = simulator.truth();
    const sim::Command command =
        driver.drive(simulator.look(), before.twist.vx, simulator.collided());
    for (const sim::Event& event : simulator.advance(kDriverPeriod, command)) {
      recording.write(event);
    }
    const sim::Truth truth = simulator.truth();
    laps.update(truth.base_in_map);
    drive.seconds = truth.stamp - kStartTime;
    drive.distance += distance(before.base_in_map, truth.base_in_map);
    drive.top_speed = std::max(drive.top_speed, truth.twist.vx);
    if (laps.laps() > drive.laps) lap_began = drive.seconds;
    drive.laps = laps.laps();
    if (terminal && steps % 50 == 0) showProgress(o, drive);
    const bool time_is_up = o.duration > 0.0 && drive.seconds >= o.duration - kDriverPeriod / 2.0;
    if (time_is_up || (o.laps > 0 && drive.laps >= o.laps)) break;
    if (o.duration == 0.0 && drive.seconds - lap_began > kLongestLap) {
      throw std::runtime_error("lap " + std::to_string(drive.laps + 1) + " was not done in " +
                               std::to_string(static_cast<int>(kLongestLap)) +
                               " s; give --duration instead of --laps where there is no loop");
    }
  }
  if (terminal) std::fprintf(stderr, "\r%40s\r", "");
  return drive;
}

void run(Options o) {
  validate(o);
  const sim::Scene scene = sim::loadScene(o.scene);
  const Pose2& start = scene.start_in_map;
  sim::Simulator simulator(scene.world, o.simulator, start, o.seed, kStartTime);
  simulator.setObstacles(scene.obstacles);

  Recording recording(o.bag, o.truth, o.simulator, kStartTime);
  const Drive drive = driveAndRecord(o, simulator, recording);
  recording.commit();
  std::printf("%s: %.1f s in %s from (%.3f, %.3f, %.3f)\n", o.bag.c_str(), drive.seconds,
              scene.world_path.c_str(), start.x, start.y, start.yaw);
  std::printf("laps %d, distance %.1f m, mean %.2f m/s, top %.2f m/s, collisions %d\n", drive.laps,
              drive.distance, drive.distance / drive.seconds, drive.top_speed,
              simulator.collisions());
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "simulate_bag",
      "Drives a simulated racecar along a wall and records what it senses in a bag.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
