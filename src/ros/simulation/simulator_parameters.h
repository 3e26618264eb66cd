// Private parameters of the simulator node.
#pragma once

#include <ros/node_handle.h>

#include <string>
#include <utility>
#include <vector>

#include "racecar_mcl/common/parameter_text.h"
#include "sim/scenario.h"
#include "sim/simulator.h"
#include "sim/wall_follower.h"

namespace racecar_mcl {

enum class Driver {
  kAuto,          ///< commands; the wall follower without commands
  kWallFollower,  ///< ignores commands
  kCommands,      ///< the car stops without commands
};

template <>
struct EnumNames<Driver> {
  static std::vector<std::pair<Driver, const char*>> all() {
    return {{Driver::kAuto, "auto"},
            {Driver::kWallFollower, "wall_follower"},
            {Driver::kCommands, "commands"}};
  }
};

template <>
struct EnumNames<sim::Side> {
  static std::vector<std::pair<sim::Side, const char*>> all() {
    return {{sim::Side::kLeft, "left"}, {sim::Side::kRight, "right"}};
  }
};

struct SimulatorNodeParameters {
  sim::ScenarioParameters scenario;
  sim::SimulatorParameters simulator;
  sim::WallFollowerParameters follower;
  Driver driver = Driver::kAuto;
  double command_timeout = 0.5;   ///< s of simulated time, after which a command expires
  double real_time_factor = 1.0;  ///< simulated seconds per second
  bool publish_odom_tf = true;    ///< odom -> base_link
  bool announce_start = false;    ///< sends the current pose to new subscribers of initialpose
  double obstacle_radius = 0.2;   ///< m, of discs added by topic
  double obstacle_walk = 2.0;     ///< m, path length of moving discs
  double obstacle_speed = 0.8;    ///< m/s, of moving discs
  int seed = 1;

  // As strings; readSimulatorParameters sets the fields they stand for.
  std::string start;  ///< "x y yaw"
};

/// Calls visit(name, field) for every parameter: string, double, int, bool or enumeration.
template <typename Parameters, typename Visit>
void visitParameters(Parameters& p, const Visit& visit) {
  visit("map", p.scenario.map);
  visit("world", p.scenario.world);
  visit("start", p.start);
  visit("obstacles", p.scenario.obstacles);
  visit("moving_obstacles", p.scenario.moving_obstacles);
  visit("seed", p.seed);

  visit("driver", p.driver);
  visit("command_timeout", p.command_timeout);
  visit("speed", p.follower.speed);
  visit("wall_distance", p.follower.wall_distance);
  visit("side", p.follower.side);

  visit("real_time_factor", p.real_time_factor);
  visit("publish_odom_tf", p.publish_odom_tf);
  visit("announce_start", p.announce_start);
  visit("obstacle_radius", p.obstacle_radius);
  visit("obstacle_walk", p.obstacle_walk);
  visit("obstacle_speed", p.obstacle_speed);

  auto& odometry = p.simulator.odometry;
  visit("odom_rate", odometry.rate);
  visit("forward_noise", odometry.noise.vx);
  visit("sideways_noise", odometry.noise.vy);
  visit("turn_noise", odometry.noise.wz);
  visit("speed_scale_error", odometry.speed_scale_error);
  visit("rotation_scale_error", odometry.rotation_scale_error);
  visit("speed_bias", odometry.speed_bias);
  visit("turn_bias", odometry.turn_bias);
  visit("slip", odometry.slip);
  visit("slip_rate", odometry.slip_rate);
  visit("slip_duration", odometry.slip_duration);
  visit("odom_dropout", odometry.dropout_rate);

  visit("odom_turn_delay", odometry.turn_delay);
  visit("odom_turn_from_command", odometry.turn_from_command);
  visit("steering_delay", p.simulator.car.steering_delay);

  auto& gyro = p.simulator.gyro;
  visit("imu", gyro.enabled);
  visit("imu_rate", gyro.rate);
  visit("gyro_noise", gyro.noise);
  visit("gyro_bias", gyro.bias);
  visit("gyro_scale_error", gyro.scale_error);
  visit("gyro_delay", gyro.delay);
  visit("gyro_in_degrees", gyro.in_degrees);

  auto& lidar = p.simulator.lidar;
  visit("scan_rate", lidar.rate);
  visit("scan_beams", lidar.beams);
  visit("instant_scans", lidar.instant);
  visit("clockwise_scans", lidar.clockwise);
  visit("range_noise", lidar.range_noise);
  visit("range_bias", lidar.range_bias);
  visit("missing_rate", lidar.missing_rate);
  visit("scan_dropout", lidar.dropout_rate);
  visit("max_range", lidar.range_max);
  visit("glass", lidar.glass.share);

  auto& rear_lidar = p.simulator.rear_lidar;
  visit("rear_lidar", rear_lidar.enabled);
  visit("rear_range_bias", rear_lidar.range_bias);
  visit("rear_clockwise_scans", rear_lidar.clockwise);
}

/// Parameters that are not set keep their defaults. Throws ParameterError on an unknown name, a
/// wrong type or a value out of range.
SimulatorNodeParameters readSimulatorParameters(const ros::NodeHandle& private_node);

}  // namespace racecar_mcl
