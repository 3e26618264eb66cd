// What the simulator reads from its private parameters.
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "sim/scene.h"
#include "sim/simulator.h"
#include "sim/wall_follower.h"

namespace racecar_mcl {

enum class Driver {
  kAuto,          ///< whoever commands; the wall follower while nobody does
  kWallFollower,  ///< commands are not heard
  kCommands,      ///< the car stands while nobody commands
};

struct SimulatorNodeParameters {
  sim::SceneParameters scene;
  sim::SimulatorParameters simulator;
  sim::WallFollowerParameters follower;
  Driver driver = Driver::kAuto;
  double command_timeout = 0.5;   ///< s, of simulated time; then a command no longer holds
  double real_time_factor = 1.0;  ///< simulated seconds per second
  bool publish_odom_tf = true;    ///< odom -> base_link
  bool announce_start = false;  ///< whoever subscribes to initialpose is told where the car is then
  double obstacle_radius = 0.2;  ///< m, of a disc that a topic puts down
  double obstacle_walk = 2.0;    ///< m, to and fro, of one that walks
  double obstacle_speed = 0.8;   ///< m/s, of one that walks
  int seed = 1;

  // As text; readSimulatorParameters sets what they mean.
  std::string start;                 ///< "x y yaw"
  std::string driver_name = "auto";  ///< auto, wall_follower, commands
  std::string side = "left";         ///< left, right: the wall that is followed
};

/// Calls visit(name, field) for every parameter: string, double, int or bool.
template <typename Parameters, typename Visit>
void visitParameters(Parameters& p, const Visit& visit) {
  visit("map", p.scene.map);
  visit("world", p.scene.world);
  visit("start", p.start);
  visit("obstacles", p.scene.obstacles);
  visit("moving_obstacles", p.scene.moving_obstacles);
  visit("seed", p.seed);

  visit("driver", p.driver_name);
  visit("command_timeout", p.command_timeout);
  visit("speed", p.follower.speed);
  visit("wall_distance", p.follower.wall_distance);
  visit("side", p.side);

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
  visit("turn_scale_error", odometry.turn_scale_error);
  visit("speed_bias", odometry.speed_bias);
  visit("turn_bias", odometry.turn_bias);
  visit("slip", odometry.slip);
  visit("slip_rate", odometry.slip_rate);
  visit("slip_duration", odometry.slip_duration);
  visit("odom_dropout", odometry.dropout_rate);

  auto& lidar = p.simulator.lidar;
  visit("scan_rate", lidar.rate);
  visit("scan_beams", lidar.beams);
  visit("instant_scans", lidar.instant);
  visit("clockwise_scans", lidar.clockwise);
  visit("range_noise", lidar.range_noise);
  visit("missing_rate", lidar.missing_rate);
  visit("scan_dropout", lidar.dropout_rate);
  visit("max_range", lidar.range_max);
  visit("glass", lidar.glass.share);
}

/// What is not set keeps its default. Throws ParameterError on a name that does not exist, a wrong
/// type or a value out of range.
SimulatorNodeParameters readSimulatorParameters(const ros::NodeHandle& private_node);

}  // namespace racecar_mcl
