// translate_parameters amcl.yaml: prints another localizer's parameter file with the names of this
// package.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>

#include "cli.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/foreign_parameters.h"

namespace racecar_mcl {
namespace {

using Texts = std::map<std::string, std::string>;

struct Options {
  std::string file;
  std::string origin;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("file", o->file, "YAML file of the other localizer's parameters")->required();
  app->add_option("--from", o->origin,
                  "amcl, lab5 or mit_pf; without it, the one that has most of the names");
}

/// The scalars of a mapping. A mapping within it, such as the name of a node, is opened.
void readTexts(const YAML::Node& mapping, Texts* texts) {
  for (const auto& entry : mapping) {
    const std::string name = entry.first.as<std::string>();
    if (entry.second.IsMap()) {
      readTexts(entry.second, texts);
    } else if (entry.second.IsScalar()) {
      (*texts)[name] = entry.second.Scalar();
    } else {
      throw ParameterError("line " + std::to_string(entry.first.Mark().line + 1) + ": " + name +
                           " must be a single value");
    }
  }
}

Texts readFile(const std::string& path) {
  try {
    const YAML::Node file = YAML::LoadFile(path);
    if (!file.IsMap()) throw ParameterError("expected a mapping of names to values");
    Texts texts;
    readTexts(file, &texts);
    return texts;
  } catch (const YAML::BadFile&) {
    throw ParameterError(path + ": the file cannot be read");
  } catch (const std::exception& error) {
    throw ParameterError(path + ": " + error.what());
  }
}

std::string likelyOrigin(const std::string& path, const Texts& texts) {
  std::map<std::string, int> count;
  for (const ForeignParameter& foreign : foreignParameters()) {
    count[foreign.origin] += static_cast<int>(texts.count(foreign.name));
  }
  const auto most = std::max_element(
      count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most->second == 0) {
    throw ParameterError(path + ": no parameter of amcl, lab5 or mit_pf; expected some");
  }
  return most->first;
}

void run(const Options& o) {
  const Texts texts = readFile(o.file);
  const std::string origin = o.origin.empty() ? likelyOrigin(o.file, texts) : o.origin;
  const ForeignTranslation translation = translateParameters(origin, texts);
  std::cout << "# From the parameters of " << origin << " in " << o.file << ".\n";
  for (const auto& [name, text] : translation.parameters) {
    std::cout << name << ": " << text << '\n';
  }
  if (!translation.notes.empty()) std::cout << "# Without effect or counterpart:\n";
  for (const std::string& note : translation.notes) std::cout << "#   " << note << '\n';
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram<racecar_mcl::Options>(
      argc, argv, "translate_parameters",
      "Prints a parameter file of amcl, of the course's lab 5 or of MIT's particle_filter with the "
      "names of this package.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
