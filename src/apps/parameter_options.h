// The options --config and --set of all programs that use the localizer.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/parameter_registry.h"

namespace racecar_mcl {

struct ParameterOptions {
  std::string config;
  std::vector<std::string> settings;  ///< name:=value
};

inline void addParameterOptions(ParameterOptions* o, CLI::App* app) {
  app->add_option("--config", o->config, "YAML file with parameters");
  app->add_option("--set", o->settings, "parameter as name:=value; overrides --config");
}

/// Defaults, overridden by the YAML file and then by the settings. Throws ParameterError.
inline LocalizerParameters readParameters(const ParameterOptions& o) {
  LocalizerParameters parameters;
  if (!o.config.empty()) readParameterFile(o.config, &parameters);
  for (const std::string& setting : o.settings) {
    const std::size_t assign = setting.find(":=");
    if (assign == std::string::npos) {
      throw ParameterError("--set is '" + setting + "'; expected name:=value");
    }
    setParameter(setting.substr(0, assign), setting.substr(assign + 2), &parameters);
  }
  return parameters;
}

}  // namespace racecar_mcl
