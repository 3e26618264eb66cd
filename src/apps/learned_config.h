// What was learned, as a configuration to localize with.
#pragma once

#include <cstdio>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "output_files.h"
#include "racecar_mcl/parameters.h"

namespace racecar_mcl {

/// Learned numbers are not known to more than four digits.
inline double toFourDigits(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return std::stod(text);
}

/// YAML: comment lines, the parameters named, and all others that are not the defaults.
inline std::string configText(const std::vector<std::string>& comments,
                              const LocalizerParameters& parameters,
                              const std::vector<std::string>& learned) {
  std::string text;
  for (const std::string& comment : comments) text += "# " + comment + "\n";
  std::map<std::string, std::string> values = parameterTexts(parameters);
  for (const std::string& name : learned) {
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

/// The configuration to stdout; into a folder, if one is named, the configuration and the table to
/// plot. Throws std::runtime_error.
inline void writeLearned(const std::string& folder, const NamedContent& config,
                         const NamedContent& table) {
  if (!folder.empty()) writeFolder(folder, {config, table});
  std::cout << config.second << std::flush;
  if (!std::cout) throw std::runtime_error("stdout: the configuration could not be written whole");
}

}  // namespace racecar_mcl
