// The options --config and --set, alike in every program that runs the localizer.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "racecar_mcl/errors.h"
#include "racecar_mcl/parameters.h"

namespace racecar_mcl {

struct ParameterOptions {
  std::string config;
  std::vector<std::string> settings;  ///< name:=value
};

inline void addParameterOptions(ParameterOptions* o, CLI::App* app) {
  app->add_option("--config", o->config, "parameters as a YAML file");
  app->add_option("--set", o->settings, "a parameter as name:=value; after --config");
}

/// The defaults, then the YAML file if one is named, then the settings. Throws ParameterError.
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
