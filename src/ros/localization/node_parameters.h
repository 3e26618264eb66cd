// Private parameters of the localization node: those of the localizer, and those of the node alone.
#pragma once

#include <ros/node_handle.h>

#include <optional>
#include <string>
#include <vector>

#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/obstacles/obstacle_detection.h"

namespace racecar_mcl {

enum class TfMode {
  kMapToBase,  ///< map -> base_link; no other node may publish a parent of base_link
  kMapToOdom,  ///< map -> odom; another node publishes odom -> base_link (REP-105)
  kOff,
};

struct NodeParameters {
  LocalizerParameters localizer;
  std::vector<std::string> scan_topics = std::vector<std::string>(1, "scan");  ///< of all lidars
  std::string map_frame = "map";
  std::string odom_frame = "odom";                  ///< for tf_mode map_to_odom and motion_from tf
  std::string particle_filter_frame = "base_link";  ///< the frame that is localized
  TfMode tf_mode = TfMode::kMapToBase;
  double transform_tolerance =
      0.03;  ///< s by which the broadcast pose is predicted and stamped ahead
  std::optional<Pose2> initial_pose;  ///< "x y yaw"; start pose, also after a bag loop
  bool global_start = false;          ///< global localization at the start
  std::string last_pose_file;         ///< of the pose to continue from; empty: none
  int seed = 1;
  double input_timeout = 1.0;  ///< s without a usable scan or odometry, after which `localized`
                               ///< becomes `degraded`
  double visualization_rate = 10.0;  ///< Hz, maximum rate of particles, markers and scans
  double diagnostics_rate = 1.0;     ///< Hz
  ObstacleDetectionParameters obstacles;
};

/// Set by a node with last_pose_file, so that it knows after a respawn that it has run before. Not
/// a parameter for users.
constexpr char kStartedParameter[] = "started";

/// Reads the private parameters; parameters that are not set keep their defaults. Throws
/// ParameterError on an unknown name, a wrong type, a value out of range or inconsistent values.
NodeParameters readNodeParameters(const ros::NodeHandle& private_node);

/// "name: old -> new" for each parameter that differs, separated by commas; "none".
std::string changesBetween(const NodeParameters& before, const NodeParameters& after);

struct ReconfigurableParameter {
  std::string name;
  std::string type;  ///< "bool", "int", "double" or "str"
  std::string text;  ///< the value
};

/// All parameters that may change while the node runs, by name.
std::vector<ReconfigurableParameter> reconfigurableParameters(const NodeParameters& parameters);

/// Throws ParameterError if a parameter differs that needs a restart of the node: frames, tf_mode,
/// motion_from, the start, the seed and clock_jump.
void requireNoRestart(const NodeParameters& before, const NodeParameters& after);

/// "x y yaw" in metres and radians, given as the parameter or option `name`. Throws ParameterError
/// on anything else.
Pose2 parsePose(const std::string& name, const std::string& text);

}  // namespace racecar_mcl
