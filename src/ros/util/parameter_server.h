// Reads a node's parameters from the ROS parameter server as strings.
#pragma once

#include <ros/node_handle.h>

#include <map>
#include <string>

namespace racecar_mcl {

/// All parameters of a private namespace by relative name (`expert/name` for one in the namespace
/// expert), formatted as in YAML. Lists are joined by spaces. Throws ParameterError on other types.
std::map<std::string, std::string> readParameterTexts(const ros::NodeHandle& private_node);

}  // namespace racecar_mcl
