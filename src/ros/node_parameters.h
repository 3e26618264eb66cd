// What the node reads from its private parameters: the localizer's own and those that only ROS
// knows.
#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <optional>
#include <string>

#include "racecar_mcl/localizer.h"

namespace racecar_mcl {

enum class TfMode {
  kMapToBase,  ///< map -> base_link; nothing else may publish a parent of base_link
  kMapToOdom,  ///< map -> odom, beside somebody's odom -> base_link (REP-105)
  kOff,
};

struct NodeParameters {
  LocalizerParameters localizer;
  std::string map_frame = "map";
  std::string odom_frame = "odom";                  ///< for tf_mode map_to_odom and motion_from tf
  std::string particle_filter_frame = "base_link";  ///< the frame that is localized
  TfMode tf_mode = TfMode::kMapToBase;
  double transform_tolerance =
      0.03;  ///< s; the broadcast pose is predicted and stamped this far ahead
  std::optional<Pose2> initial_pose;  ///< "x y yaw"; start here, and again when a bag loops
  bool global_start = false;          ///< start anywhere on the map
  int seed = 1;
  double max_silence = 1.0;  ///< s without a usable scan or odometry; then what was localized is
                             ///< degraded
  double visualization_rate = 10.0;  ///< Hz, at most; particles, markers and scans
  double diagnostics_rate = 1.0;     ///< Hz
};

/// Reads the private parameters; what is not set keeps its default. Throws ParameterError on a name
/// that does not exist, a wrong type, a value out of range, or values that contradict each other.
NodeParameters readNodeParameters(const ros::NodeHandle& private_node);

/// "x y yaw" in metres and radians, given as the parameter or option `name`. Throws ParameterError
/// on anything else.
Pose2 parsePose(const std::string& name, const std::string& text);

}  // namespace racecar_mcl
