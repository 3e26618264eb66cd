#include "ros/localization/node_parameters.h"

#include <ros/names.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/parameter_text.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/localizer/foreign_parameters.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "ros/conversions/message_conversions.h"
#include "ros/util/parameter_server.h"

namespace racecar_mcl {

template <>
struct EnumNames<TfMode> {
  static std::vector<std::pair<TfMode, const char*>> all() {
    return {{TfMode::kMapToBase, "map_to_base"},
            {TfMode::kMapToOdom, "map_to_odom"},
            {TfMode::kOff, "off"},
            {TfMode::kOff, "false"}};  // YAML reads a bare off as false
  }
};

/// An empty string means no pose.
void parseParameter(const std::string& name, const std::string& text, std::optional<Pose2>* pose) {
  *pose = text.empty() ? std::nullopt : std::optional<Pose2>(parsePose(name, text));
}

std::string parameterText(const std::optional<Pose2>& pose) {
  if (!pose) return "";
  return parameterText(pose->x) + " " + parameterText(pose->y) + " " + parameterText(pose->yaw);
}

namespace {

/// Calls visit(name, field) for every parameter of the node alone.
template <typename Parameters, typename Visit>
void forEachNodeParameter(Parameters& p, const Visit& visit) {
  visit("scan_topics", p.scan_topics);
  visit("map_frame", p.map_frame);
  visit("odom_frame", p.odom_frame);
  visit("particle_filter_frame", p.particle_filter_frame);
  visit("tf_mode", p.tf_mode);
  visit("transform_tolerance", p.transform_tolerance);
  visit("initial_pose", p.initial_pose);
  visit("global_start", p.global_start);
  visit("last_pose_file", p.last_pose_file);
  visit("input_timeout", p.input_timeout);
  visit("visualization_rate", p.visualization_rate);
  visit("seed", p.seed);
  visit("diagnostics_rate", p.diagnostics_rate);
  visit("obstacle_distance", p.obstacles.obstacle_distance);
  visit("obstacle_min_returns", p.obstacles.obstacle_min_returns);
}

bool isNodeParameter(NodeParameters& p, const std::string& name) {
  bool found = false;
  forEachNodeParameter(p, [&](const std::string& known, const auto&) { found |= name == known; });
  return found;
}

std::map<std::string, std::string> parameterTexts(const NodeParameters& parameters) {
  std::map<std::string, std::string> texts = racecar_mcl::parameterTexts(parameters.localizer);
  forEachNodeParameter(parameters, [&](const std::string& name, const auto& field) {
    texts[name] = parameterText(field);
  });
  return texts;
}

/// The names of the parameters that differ, with their old and new values.
std::map<std::string, std::pair<std::string, std::string>> differences(
    const NodeParameters& before, const NodeParameters& after) {
  std::map<std::string, std::pair<std::string, std::string>> found;
  const std::map<std::string, std::string> old_texts = parameterTexts(before);
  for (const auto& [name, text] : parameterTexts(after)) {
    const std::string& old_text = old_texts.at(name);
    if (text != old_text) found[name] = {old_text, text};
  }
  return found;
}

bool needsRestart(const std::string& name) {
  const char* const fixed[] = {
      "scan_topics",    "map_frame",   "odom_frame",       "particle_filter_frame",
      "tf_mode",        "motion_from", "initial_pose",     "global_start",
      "last_pose_file", "seed",        "expert/clock_jump"};
  return std::find(std::begin(fixed), std::end(fixed), name) != std::end(fixed);
}

/// Replaces the names of the localizer that the parameter `compat` names, if it is set.
std::map<std::string, std::string> translated(std::map<std::string, std::string> texts) {
  texts.erase(kStartedParameter);
  const auto compat = texts.find("compat");
  if (compat == texts.end()) return texts;
  const std::string origin = compat->second;
  texts.erase(compat);
  if (origin.empty()) return texts;
  const ForeignTranslation translation = translateParameters(origin, texts);
  for (const std::string& note : translation.notes) {
    ROS_INFO("parameter of %s without effect: %s", origin.c_str(), note.c_str());
  }
  return translation.parameters;
}

/// Removes leading slashes, which tf2 does not accept.
void stripFrames(NodeParameters* p) {
  for (std::string* frame : {&p->map_frame, &p->odom_frame, &p->particle_filter_frame}) {
    *frame = stripLeadingSlash(*frame);
  }
}

void validateScanTopics(const std::vector<std::string>& topics) {
  std::set<std::string> names;
  bool are_valid = !topics.empty();
  for (const std::string& topic : topics) {
    std::string problem;
    are_valid = are_valid && ros::names::validate(topic, problem) && names.insert(topic).second;
  }
  if (!are_valid) {
    refuseParameter("scan_topics", parameterText(topics), "different names of topics");
  }
}

void validate(const NodeParameters& p) {
  validateScanTopics(p.scan_topics);
  const bool from_tf = p.localizer.odometry.motion_from == MotionFrom::kTf;
  const std::pair<const char*, const std::string&> frames[] = {
      {"map_frame", p.map_frame},
      {"odom_frame", p.odom_frame},
      {"particle_filter_frame", p.particle_filter_frame}};
  for (const auto& [name, frame] : frames) {
    if (frame.empty()) refuseParameter(name, frame, "the name of a frame");
  }
  requireNotNegative("seed", p.seed);
  requireWithin("transform_tolerance", p.transform_tolerance, 0.0, 1.0, "s");
  requirePositive("input_timeout", p.input_timeout, "s");
  requirePositive("visualization_rate", p.visualization_rate, "Hz");
  requirePositive("diagnostics_rate", p.diagnostics_rate, "Hz");
  racecar_mcl::validate(p.obstacles);
  std::ostringstream problem;
  if (p.initial_pose && p.global_start) {
    problem << "initial_pose and global_start are both set; expected at most one of them";
  } else if (from_tf && p.tf_mode == TfMode::kMapToBase) {
    problem << "tf_mode is map_to_base though motion_from is tf: '" << p.particle_filter_frame
            << "' cannot have two parents; expected map_to_odom or off";
  } else if (p.map_frame == p.particle_filter_frame ||
             ((from_tf || p.tf_mode == TfMode::kMapToOdom) &&
              (p.odom_frame == p.map_frame || p.odom_frame == p.particle_filter_frame))) {
    problem << "map_frame '" << p.map_frame << "', odom_frame '" << p.odom_frame
            << "' and particle_filter_frame '" << p.particle_filter_frame << "' must differ";
  }
  if (!problem.str().empty()) throw ParameterError(problem.str());
}

}  // namespace

Pose2 parsePose(const std::string& name, const std::string& text) {
  std::istringstream stream(text);
  Pose2 pose;
  if (!(stream >> pose.x >> pose.y >> pose.yaw) || !(stream >> std::ws).eof() ||
      !isWithin(pose, kMaxCoordinate)) {
    refuseParameter(name, text, "'x y yaw' in metres (up to 1e7) and radians");
  }
  pose.yaw = wrapAngle(pose.yaw);
  return pose;
}

NodeParameters readNodeParameters(const ros::NodeHandle& private_node) {
  NodeParameters parameters;
  std::string problems;
  for (const auto& [name, text] : translated(readParameterTexts(private_node))) {
    try {
      if (isNodeParameter(parameters, name)) {
        setByName(name, text, [&](const auto& visit) { forEachNodeParameter(parameters, visit); });
      } else {
        setParameter(name, text, &parameters.localizer);
      }
    } catch (const ParameterError& error) {
      problems += (problems.empty() ? "" : "; ") + std::string(error.what());
    }
  }
  if (!problems.empty()) throw ParameterError(problems);
  stripFrames(&parameters);
  validate(parameters);
  racecar_mcl::validate(parameters.localizer);
  return parameters;
}

std::string changesBetween(const NodeParameters& before, const NodeParameters& after) {
  std::string changes;
  for (const auto& [name, values] : differences(before, after)) {
    changes += (changes.empty() ? "" : ", ") + name + ": " + values.first + " -> " + values.second;
  }
  return changes.empty() ? "none" : changes;
}

std::vector<ReconfigurableParameter> reconfigurableParameters(const NodeParameters& parameters) {
  std::map<std::string, std::string> types = parameterTypes();
  forEachNodeParameter(parameters, [&](const std::string& name, const auto& field) {
    types[name] = parameterType(field);
  });
  std::vector<ReconfigurableParameter> found;
  for (const auto& [name, text] : parameterTexts(parameters)) {
    if (!needsRestart(name)) found.push_back({name, types.at(name), text});
  }
  return found;
}

void requireNoRestart(const NodeParameters& before, const NodeParameters& after) {
  for (const auto& [name, values] : differences(before, after)) {
    if (!needsRestart(name)) continue;
    throw ParameterError(name + " is '" + values.first + "' and cannot become '" + values.second +
                         "' while the node runs; restart the node");
  }
}

}  // namespace racecar_mcl
