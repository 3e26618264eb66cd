// Checks of the paths on the command line: no program replaces its own input.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {

/// Whether both paths name one file, also by links or if it does not exist yet.
inline bool isSameFile(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error);
}

/// Throws ParameterError if an output is the same file as an input or as another output. Empty
/// paths stand for options that are not set.
inline void requireSeparateFiles(const std::vector<std::string>& outputs,
                                 const std::vector<std::string>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const std::string& input : inputs) {
      if (input.empty() || !isSameFile(outputs[i], input)) continue;
      throw ParameterError("the output " + outputs[i] + " would replace the input " + input +
                           "; expected another file");
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (outputs[j].empty() || !isSameFile(outputs[i], outputs[j])) continue;
      throw ParameterError("two outputs are the same file, " + outputs[i]);
    }
  }
}

/// The paths of files in the folder of an option; none if it is not set.
inline std::vector<std::string> filesIn(const std::string& folder,
                                        const std::vector<std::string>& names) {
  std::vector<std::string> paths;
  if (folder.empty()) return paths;
  for (const std::string& name : names) {
    paths.push_back((std::filesystem::path(folder) / name).string());
  }
  return paths;
}

}  // namespace racecar_mcl
