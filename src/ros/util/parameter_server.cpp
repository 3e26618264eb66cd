#include "ros/util/parameter_server.h"

#include <XmlRpcValue.h>

#include <sstream>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/parameter_text.h"

namespace racecar_mcl {
namespace {

/// A value formatted as in YAML.
std::string textOf(const std::string& name, XmlRpc::XmlRpcValue value) {
  std::ostringstream text;
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeBoolean:
      text << (static_cast<bool>(value) ? "true" : "false");
      break;
    case XmlRpc::XmlRpcValue::TypeInt:
      text << static_cast<int>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeDouble:
      text << parameterText(static_cast<double>(value));
      break;
    case XmlRpc::XmlRpcValue::TypeString:
      text << static_cast<std::string>(value);
      break;
    case XmlRpc::XmlRpcValue::TypeArray:
      for (int i = 0; i < value.size(); ++i) text << (i ? " " : "") << textOf(name, value[i]);
      break;
    default:
      throw ParameterError(name + " must be a single value");
  }
  return text.str();
}

/// Adds the members of a structure, recursively.
void flatten(const std::string& prefix, XmlRpc::XmlRpcValue& all,
             std::map<std::string, std::string>* texts) {
  for (auto& [name, value] : all) {
    if (value.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
      flatten(prefix + name + "/", value, texts);
    } else {
      (*texts)[prefix + name] = textOf(prefix + name, value);
    }
  }
}

}  // namespace

std::map<std::string, std::string> readParameterTexts(const ros::NodeHandle& private_node) {
  std::map<std::string, std::string> texts;
  XmlRpc::XmlRpcValue all;
  if (private_node.getParam(private_node.getNamespace(), all) &&
      all.getType() == XmlRpc::XmlRpcValue::TypeStruct) {
    flatten("", all, &texts);
  }
  return texts;
}

}  // namespace racecar_mcl
