#include "ros/simulation/simulator_parameters.h"

#include "racecar_mcl/common/validation.h"
#include "ros/localization/node_parameters.h"
#include "ros/util/parameter_server.h"

namespace racecar_mcl {

namespace {

void validate(const SimulatorNodeParameters& p) {
  p.simulator.validate();
  p.follower.validate();
  p.scenario.validate();
  requirePositive("command_timeout", p.command_timeout, "s");
  requireWithin("real_time_factor", p.real_time_factor, 0.05, 100.0);
  requirePositive("obstacle_radius", p.obstacle_radius, "m");
  requireNotNegative("obstacle_walk", p.obstacle_walk, "m");
  requireNotNegative("obstacle_speed", p.obstacle_speed, "m/s");
  requireNotNegative("seed", p.seed);
}

}  // namespace

SimulatorNodeParameters readSimulatorParameters(const ros::NodeHandle& private_node) {
  SimulatorNodeParameters p;
  for (const auto& [name, text] : readParameterTexts(private_node)) {
    setByName(name, text, [&](const auto& visit) { visitParameters(p, visit); });
  }
  if (!p.start.empty()) p.scenario.start = parsePose("start", p.start);
  p.scenario.seed = static_cast<std::uint64_t>(p.seed);
  sim::LidarParameters& lidar = p.simulator.lidar;
  lidar.sweep_time = lidar.field_of_view / (2.0 * kPi) / lidar.rate;  // constant mirror speed
  p.scenario.car = p.simulator.car;
  p.follower.car = p.simulator.car;
  validate(p);
  return p;
}

}  // namespace racecar_mcl
