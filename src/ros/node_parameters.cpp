#include "ros/node_parameters.h"

#include <XmlRpcValue.h>

#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/parameters.h"
#include "racecar_mcl/require.h"
#include "ros/conversions.h"

namespace racecar_mcl {
namespace {

/// A parameter server's value as YAML would write it.
std::string textOf(const std::string& name, XmlRpc::XmlRpcValue value) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::digits10);
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      text << (static_cast<bool>(value) ? "true" : "false");
      break;
    case XmlRpc::XmlRpcValue::TypeInt:
      text << static_cast<int>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      text << static_cast<double>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeString:
      text << static_cast<std::string>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeArray:
      for (int i = 0; i < value.size(); ++i) text << (i ? " " : "") << textOf(name, value[i]);
      break;
    default:
      throw ParameterError(name + " must be a single value, not a structure");
  }
  return text.str();
}

[[noreturn]] void refuse(const std::string& name, const std::string& text,
                         const std::string& expected) {
  throw ParameterError(name + " is '" + text + "'; expected " + expected);
}

double parseNumber(const std::string& name, const std::string& text) {
  std::istringstream stream(text);
  double value = 0.0;
  if (!(stream >> value) || !(stream >> std::ws).eof() || !std::isfinite(value)) {
    refuse(name, text, "a finite number");
  }
  return value;
}

int parseCount(const std::string& name, const std::string& text) {
  const double value = parseNumber(name, text);
  if (value != std::floor(value) || value < 0.0 ||
      value > static_cast<double>(std::numeric_limits<int>::max())) {
    refuse(name, text, "a whole number from 0 on");
  }
  return static_cast<int>(value);
}

std::string parseFrame(const std::string& name, const std::string& text) {
  const std::string frame = stripLeadingSlash(text);
  if (frame.empty()) refuse(name, text, "the name of a frame");
  return frame;
}

TfMode parseTfMode(const std::string& text) {
  if (text == "map_to_base") return TfMode::kMapToBase;
  if (text == "map_to_odom") return TfMode::kMapToOdom;
  if (text == "off" || text == "false") return TfMode::kOff;  // YAML reads a bare off as false
  refuse("tf_mode", text, "map_to_base, map_to_odom or off");
}

bool parseFlag(const std::string& name, const std::string& text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  refuse(name, text, "true or false");
}

/// Sets a parameter that only the node has; false when the name is none of them.
bool setNodeParameter(const std::string& name, const std::string& text, NodeParameters* p) {
  if (name == "map_frame") {
    p->map_frame = parseFrame(name, text);
  } else if (name == "odom_frame") {
    p->odom_frame = parseFrame(name, text);
  } else if (name == "particle_filter_frame") {
    p->particle_filter_frame = parseFrame(name, text);
  } else if (name == "tf_mode") {
    p->tf_mode = parseTfMode(text);
  } else if (name == "transform_tolerance") {
    p->transform_tolerance = parseNumber(name, text);
  } else if (name == "initial_pose") {
    if (!text.empty()) p->initial_pose = parsePose(name, text);
  } else if (name == "global_start") {
    p->global_start = parseFlag(name, text);
  } else if (name == "seed") {
    p->seed = parseCount(name, text);
  } else if (name == "max_silence") {
    p->max_silence = parseNumber(name, text);
  } else if (name == "visualization_rate") {
    p->visualization_rate = parseNumber(name, text);
  } else if (name == "diagnostics_rate") {
    p->diagnostics_rate = parseNumber(name, text);
  } else {
    return false;
  }
  return true;
}

void validate(const NodeParameters& p) {
  const bool from_tf = p.localizer.odometry.motion_from == MotionFrom::kTf;
  requireWithin("transform_tolerance", p.transform_tolerance, 0.0, 1.0, "s");
  requirePositive("max_silence", p.max_silence, "s");
  requirePositive("visualization_rate", p.visualization_rate, "Hz");
  requirePositive("diagnostics_rate", p.diagnostics_rate, "Hz");
  std::ostringstream problem;
  if (p.initial_pose && p.global_start) {
    problem << "initial_pose and global_start are both set; the car starts at one or anywhere";
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
  if (!(stream >> pose.x >> pose.y >> pose.yaw) || !(stream >> std::ws).eof() || !isFinite(pose)) {
    refuse(name, text, "'x y yaw' in metres and radians");
  }
  pose.yaw = wrapAngle(pose.yaw);
  return pose;
}

NodeParameters readNodeParameters(const ros::NodeHandle& private_node) {
  NodeParameters parameters;
  XmlRpc::XmlRpcValue all;
  if (private_node.getParam(private_node.getNamespace(), all) &&
      all.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
    for (auto& [name, value] : all) {
      const std::string text = textOf(name, value);
      if (!setNodeParameter(name, text, &parameters)) {
        setParameter(name, text, &parameters.localizer);
      }
    }
  }
  validate(parameters);
  racecar_mcl::validate(parameters.localizer);
  return parameters;
}

}  // namespace racecar_mcl
