// Parameters by name and as text: shared by YAML files, command lines and the ROS parameter server.
//
// Each parameter struct has one function that calls visit(name, field) for every parameter. That
// list is the only mapping between names and fields.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {

/// The values of an enumeration with their names: `static std::vector<std::pair<Enum, const
/// char*>> all()`. If a value has several names, the first one is written.
template <typename Enum>
struct EnumNames;

/// Sets a value from its text. Throws ParameterError with the name, the text and what was expected.
void parseParameter(const std::string& name, const std::string& text, double* value);
void parseParameter(const std::string& name, const std::string& text, int* value);
void parseParameter(const std::string& name, const std::string& text, bool* value);  ///< or 1, 0
void parseParameter(const std::string& name, const std::string& text, std::string* value);
/// Words separated by spaces.
void parseParameter(const std::string& name, const std::string& text,
                    std::vector<std::string>* value);

/// Throws ParameterError: the text is not a valid value.
[[noreturn]] void refuseParameter(const std::string& name, const std::string& text,
                                  const std::string& expected);

template <typename Enum, typename = std::enable_if_t<std::is_enum_v<Enum>>>
void parseParameter(const std::string& name, const std::string& text, Enum* value) {
  std::string expected = "one of";
  for (const auto& [known, word] : EnumNames<Enum>::all()) {
    if (text == word) {
      *value = known;
      return;
    }
    expected += std::string(" ") + word;
  }
  refuseParameter(name, text, expected);
}

/// The value as YAML text.
std::string parameterText(double value);
std::string parameterText(int value);
std::string parameterText(bool value);
std::string parameterText(const std::string& value);
std::string parameterText(const std::vector<std::string>& value);

template <typename Enum, typename = std::enable_if_t<std::is_enum_v<Enum>>>
std::string parameterText(Enum value) {
  for (const auto& [known, word] : EnumNames<Enum>::all()) {
    if (known == value) return word;
  }
  return "";
}

/// The type of a parameter: "bool", "int", "double", or "str" for everything written as a word.
template <typename Value>
const char* parameterType(const Value& /*value*/) {
  if (std::is_same_v<Value, bool>) return "bool";
  if (std::is_same_v<Value, int>) return "int";
  return std::is_same_v<Value, double> ? "double" : "str";
}

/// The Levenshtein distance of two names.
std::size_t editDistance(const std::string& a, const std::string& b);

/// Sets one of the parameters that visit_all(visit) visits. Throws ParameterError on an invalid
/// text and on an unknown name; the message then suggests the most similar known name.
template <typename VisitAll>
void setByName(const std::string& name, const std::string& text, const VisitAll& visit_all) {
  bool found = false;
  visit_all([&](const std::string& known, auto& field) {
    if (name != known) return;
    parseParameter(name, text, &field);
    found = true;
  });
  if (found) return;
  std::string nearest;
  std::size_t nearest_distance = std::numeric_limits<std::size_t>::max();
  visit_all([&](const std::string& known, const auto& /*field*/) {
    // A known name given without its prefix is the best suggestion.
    const std::string bare = known.substr(known.rfind('/') + 1);
    const std::size_t distance = name == bare ? 0 : editDistance(name, known);
    if (distance >= nearest_distance) return;
    nearest_distance = distance;
    nearest = known;
  });
  throw ParameterError("there is no parameter '" + printable(name) + "'; did you mean '" + nearest +
                       "'?");
}

}  // namespace racecar_mcl
