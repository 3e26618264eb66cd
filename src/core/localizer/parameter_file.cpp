// Parameters of the localizer from YAML files.
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/parameter_registry.h"

namespace racecar_mcl {
namespace {

/// Reads a mapping of names to values, where `expert: {name: value}` stands for `expert/name:
/// value`.
void readMapping(const YAML::Node& mapping, const std::string& path, const std::string& prefix,
                 LocalizerParameters* parameters) {
  for (const auto& entry : mapping) {
    try {
      const std::string name = prefix + entry.first.as<std::string>();
      if (entry.second.IsMap() && prefix.empty()) {
        readMapping(entry.second, path, name + "/", parameters);
      } else if (entry.second.IsScalar()) {
        setParameter(name, entry.second.Scalar(), parameters);
      } else {
        throw ParameterError(name + " must be a single value");
      }
    } catch (const std::exception& error) {
      const std::string what = error.what();
      if (what.rfind(path, 0) == 0) throw;
      throw ParameterError(path + ", line " + std::to_string(entry.first.Mark().line + 1) + ": " +
                           what);
    }
  }
}

}  // namespace

void readParameterFile(const std::string& path, LocalizerParameters* parameters) {
  // A directory would be read as an empty file.
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw ParameterError(path + ": expected a file");
  }
  YAML::Node file;
  try {
    file = YAML::LoadFile(path);
  } catch (const YAML::BadFile&) {
    throw ParameterError(path + ": the parameter file cannot be read");
  } catch (const YAML::Exception& error) {
    throw ParameterError(path + ": not YAML: " + error.what());
  }
  if (file.IsNull()) return;
  if (!file.IsMap()) throw ParameterError(path + ": expected a mapping of names to values");
  LocalizerParameters read = *parameters;
  readMapping(file, path, "", &read);
  *parameters = read;
}

}  // namespace racecar_mcl
