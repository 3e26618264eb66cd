#include "ros/localization/reconfigure_server.h"

#include <dynamic_reconfigure/ConfigDescription.h>

#include <limits>
#include <string>
#include <utility>

namespace racecar_mcl {
namespace {

using dynamic_reconfigure::Config;

/// The values as a message, each by its type.
Config toConfig(const NodeParameters& parameters) {
  Config config;
  const auto add = [](const std::string& name, auto value, auto* list) {
    list->emplace_back();
    list->back().name = name;
    list->back().value = value;
  };
  for (const ReconfigurableParameter& parameter : reconfigurableParameters(parameters)) {
    const std::string& name = parameter.name;
    const std::string& text = parameter.text;
    if (parameter.type == "bool") add(name, text == "true", &config.bools);
    if (parameter.type == "int") add(name, std::stoi(text), &config.ints);
    if (parameter.type == "double") add(name, std::stod(text), &config.doubles);
    if (parameter.type == "str") add(name, text, &config.strs);
  }
  config.groups.emplace_back();
  config.groups.back().name = "Default";
  config.groups.back().state = true;
  return config;
}

/// The ranges are checked when a value is set; docs/parameters.md lists them.
Config limits(Config config, bool upper) {
  for (auto& parameter : config.bools) parameter.value = upper;
  for (auto& parameter : config.ints) {
    parameter.value = upper ? std::numeric_limits<int>::max() : std::numeric_limits<int>::min();
  }
  for (auto& parameter : config.doubles) {
    const double infinity = std::numeric_limits<double>::infinity();
    parameter.value = upper ? infinity : -infinity;
  }
  for (auto& parameter : config.strs) parameter.value.clear();
  return config;
}

dynamic_reconfigure::ConfigDescription describe(const NodeParameters& parameters) {
  dynamic_reconfigure::ConfigDescription description;
  const NodeParameters defaults;
  description.dflt = toConfig(defaults);
  description.min = limits(description.dflt, false);
  description.max = limits(description.dflt, true);
  dynamic_reconfigure::Group group;
  group.name = "Default";
  for (const ReconfigurableParameter& parameter : reconfigurableParameters(parameters)) {
    dynamic_reconfigure::ParamDescription one;
    one.name = parameter.name;
    one.type = parameter.type;
    one.description = "see docs/parameters.md";
    group.parameters.push_back(one);
  }
  description.groups.push_back(group);
  return description;
}

/// Sets the parameters of one type that are to change.
template <typename List>
void setChanged(const List& before, const List& wanted, const ros::NodeHandle& node) {
  for (const auto& parameter : wanted) {
    for (const auto& old : before) {
      const bool changes = parameter.name == old.name && parameter.value != old.value;
      if (changes) node.setParam(parameter.name, parameter.value);
    }
  }
}

void setChanged(const Config& before, const Config& wanted, const ros::NodeHandle& node) {
  for (const auto& parameter : wanted.bools) {
    for (const auto& old : before.bools) {
      const bool changes = parameter.name == old.name && parameter.value != old.value;
      if (changes) node.setParam(parameter.name, static_cast<bool>(parameter.value));
    }
  }
  setChanged(before.ints, wanted.ints, node);
  setChanged(before.doubles, wanted.doubles, node);
  setChanged(before.strs, wanted.strs, node);
}

}  // namespace

ReconfigureServer::ReconfigureServer(const ros::NodeHandle& private_node,
                                     const NodeParameters& parameters,
                                     std::function<NodeParameters()> reload)
    : private_node_(private_node),
      reload_(std::move(reload)),
      descriptions_(private_node_.advertise<dynamic_reconfigure::ConfigDescription>(
          "parameter_descriptions", 1, true)),
      updates_(private_node_.advertise<Config>("parameter_updates", 1, true)) {
  descriptions_.publish(describe(parameters));
  publish(parameters);
  service_ =
      private_node_.advertiseService("set_parameters", &ReconfigureServer::onSetParameters, this);
}

void ReconfigureServer::publish(const NodeParameters& parameters) {
  current_ = toConfig(parameters);
  updates_.publish(current_);
}

bool ReconfigureServer::onSetParameters(dynamic_reconfigure::Reconfigure::Request& request,
                                        dynamic_reconfigure::Reconfigure::Response& response) {
  setChanged(current_, request.config, private_node_);
  response.config = toConfig(reload_());
  // After a refusal the parameter server has the values in use again.
  setChanged(request.config, response.config, private_node_);
  return true;
}

}  // namespace racecar_mcl
