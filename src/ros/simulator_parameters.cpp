#include "ros/simulator_parameters.h"

#include <XmlRpcValue.h>

#include <map>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/require.h"
#include "ros/node_parameters.h"

namespace racecar_mcl {
namespace {

using XmlRpc::XmlRpcValue;

[[noreturn]] void refuseType(const std::string& name, const char* expected) {
  throw ParameterError(name + " is of the wrong type; expected " + expected);
}

void assign(const std::string& name, XmlRpcValue& value, std::string& field) {
  if (value.getType() != XmlRpcValue::TypeString) refuseType(name, "a text");
  field = static_cast<std::string>(value);
}

void assign(const std::string& name, XmlRpcValue& value, double& field) {
  if (value.getType() == XmlRpcValue::TypeInt) {
    field = static_cast<int>(value);
  } else if (value.getType() == XmlRpcValue::TypeDouble) {
    field = static_cast<double>(value);
  } else {
    refuseType(name, "a number");
  }
}

void assign(const std::string& name, XmlRpcValue& value, int& field) {
  if (value.getType() != XmlRpcValue::TypeInt) refuseType(name, "a whole number");
  field = static_cast<int>(value);
}

void assign(const std::string& name, XmlRpcValue& value, bool& field) {
  if (value.getType() != XmlRpcValue::TypeBoolean) refuseType(name, "true or false");
  field = static_cast<bool>(value);
}

template <typename Value>
Value choose(const std::string& name, const std::string& text,
             const std::map<std::string, Value>& choices) {
  const auto found = choices.find(text);
  if (found != choices.end()) return found->second;
  std::string expected;
  for (const auto& [choice, value] : choices) expected += (expected.empty() ? "" : ", ") + choice;
  throw ParameterError(name + " is '" + text + "'; expected one of " + expected);
}

void validate(const SimulatorNodeParameters& p) {
  p.simulator.validate();
  p.follower.validate();
  p.scene.validate();
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
  XmlRpcValue all;
  if (private_node.getParam(private_node.getNamespace(), all) &&
      all.getType() == XmlRpcValue::TypeStruct) {
    for (auto& entry : all) {
      const std::string& name = entry.first;
      bool known = false;
      visitParameters(p, [&](const char* field_name, auto& field) {
        if (name != field_name) return;
        assign(name, entry.second, field);
        known = true;
      });
      if (!known) {
        throw ParameterError("the simulator has no parameter '" + name +
                             "'; docs/simulator.md lists those it has");
      }
    }
  }
  p.driver = choose<Driver>("driver", p.driver_name,
                            {{"auto", Driver::kAuto},
                             {"wall_follower", Driver::kWallFollower},
                             {"commands", Driver::kCommands}});
  p.follower.side =
      choose<sim::Side>("side", p.side, {{"left", sim::Side::kLeft}, {"right", sim::Side::kRight}});
  if (!p.start.empty()) p.scene.start = parsePose("start", p.start);
  p.scene.seed = static_cast<std::uint64_t>(p.seed);
  sim::LidarParameters& lidar = p.simulator.lidar;
  lidar.sweep_time = lidar.field_of_view / (2.0 * kPi) / lidar.rate;  // its mirror turns evenly
  p.scene.car = p.simulator.car;
  p.follower.car = p.simulator.car;
  validate(p);
  return p;
}

}  // namespace racecar_mcl
