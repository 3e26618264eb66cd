// Writes estimated parameters as a configuration.
#pragma once

#include <cstdio>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "offline/output_files.h"
#include "racecar_mcl/localizer/parameter_registry.h"

namespace racecar_mcl {

/// Rounds to four significant digits.
inline double toFourDigits(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return std::stod(text);
}

/// YAML with comments, the estimated parameters, and all others that differ from their defaults.
inline std::string configText(const std::vector<std::string>& comments,
                              const LocalizerParameters& parameters,
                              const std::vector<std::string>& estimated) {
  std::string text;
  for (const std::string& comment : comments) text += "# " + comment + "\n";
  std::map<std::string, std::string> values = parameterTexts(parameters);
  for (const std::string& name : estimated) {
    text += name + ": " + values.at(name) + "\n";
    values.erase(name);
  }
  const std::map<std::string, std::string> defaults = parameterTexts({});
  bool first = true;
  for (const auto& [name, value] : values) {
    if (value == defaults.at(name)) continue;
    if (first) text += "\n# as configured\n";
    first = false;
    text += name + ": " + value + "\n";
  }
  return text;
}

/// Prints the configuration; if `folder` is not empty, also writes it there with the table for
/// plotting. Throws std::runtime_error.
inline void writeCalibration(const std::string& folder, const NamedContent& config,
                             const NamedContent& table) {
  if (!folder.empty()) writeFolder(folder, {config, table});
  std::cout << config.second << std::flush;
  if (!std::cout) throw std::runtime_error("stdout: cannot write the whole configuration");
}

}  // namespace racecar_mcl
