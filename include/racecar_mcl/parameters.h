// Parameters by name: one list that the YAML files, the command line, the ROS parameter server and
// the tests share.
#pragma once

#include <map>
#include <string>

#include "racecar_mcl/localizer.h"

namespace racecar_mcl {

/// Every parameter of the localizer by its public name, with its value as YAML would write it.
std::map<std::string, std::string> parameterTexts(const LocalizerParameters& parameters);

/// Sets one parameter from its text. Throws ParameterError on a name that does not exist (naming
/// the nearest that does) and on a text that is not of the parameter's type. Ranges are checked by
/// `validate`.
void setParameter(const std::string& name, const std::string& text,
                  LocalizerParameters* parameters);

/// Sets parameters from a YAML file, a flat mapping of names to values. Throws ParameterError
/// naming the file and the line; the parameters then stay as they were.
void readParameterFile(const std::string& path, LocalizerParameters* parameters);

}  // namespace racecar_mcl
