// Parameters of the localizer by name, for YAML files, command lines and the ROS parameter server.
#pragma once

#include <map>
#include <string>

#include "racecar_mcl/localizer/localizer.h"

namespace racecar_mcl {

/// All parameters of the localizer: public names and values as YAML text.
std::map<std::string, std::string> parameterTexts(const LocalizerParameters& parameters);

/// The names of all parameters with their types: "bool", "int", "double", or "str" (also choices).
std::map<std::string, std::string> parameterTypes();

/// Whether a map built by makeLocalizationMap with the one set of parameters cannot be used with
/// the other.
bool needsNewMap(const LocalizerParameters& one, const LocalizerParameters& other);

/// Sets one parameter from its text. Throws ParameterError on an unknown name (naming the
/// counterpart of another localizer's parameter, else the most similar one) and on a text that is
/// not of the parameter's type. Does not check ranges; `validate` does.
void setParameter(const std::string& name, const std::string& text,
                  LocalizerParameters* parameters);

/// Sets parameters from a YAML file: a mapping of names to values, in which `expert: {name: value}`
/// stands for `expert/name: value`. Throws ParameterError with the file and the line; the
/// parameters are then unchanged.
void readParameterFile(const std::string& path, LocalizerParameters* parameters);

}  // namespace racecar_mcl
