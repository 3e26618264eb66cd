// The options --config and --set, alike in every program that runs the localizer.
#pragma once

#include <string>
#include <vector>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/parameters.h"

namespace racecar_mcl {

/// The defaults, then a YAML file if one is named, then settings as name:=value. Throws
/// ParameterError.
inline LocalizerParameters readParameters(const std::string& config,
                                          const std::vector<std::string>& settings) {
  LocalizerParameters parameters;
  if (!config.empty()) readParameterFile(config, &parameters);
  for (const std::string& setting : settings) {
    const std::size_t assign = setting.find(":=");
    if (assign == std::string::npos) {
      throw ParameterError("--set is '" + setting + "'; expected name:=value");
    }
    setParameter(setting.substr(0, assign), setting.substr(assign + 2), &parameters);
  }
  return parameters;
}

}  // namespace racecar_mcl
