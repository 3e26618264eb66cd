// docs/simulator.md lists all parameters of the simulator with their defaults.
#include "ros/simulation/simulator_parameters.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

namespace racecar_mcl {
namespace {

using Texts = std::map<std::string, std::string>;

/// The rows under "## Parameters": | `name` | `default` | ...
Texts documentedDefaults() {
  std::ifstream file(RACECAR_MCL_SOURCE_DIR "/docs/simulator.md");
  EXPECT_TRUE(file);
  Texts texts;
  bool parameters = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("## ", 0) == 0) parameters = line == "## Parameters";
    if (!parameters || line.rfind("| `", 0) != 0) continue;
    std::istringstream cells(line);
    std::string before, name, between, value;
    std::getline(cells, before, '`');
    std::getline(cells, name, '`');
    std::getline(cells, between, '`');
    std::getline(cells, value, '`');
    EXPECT_EQ(between, " | ") << line;
    EXPECT_TRUE(texts.emplace(name, value).second) << name << " is there twice";
  }
  return texts;
}

TEST(SimulatorPage, GivesEveryParameterWithItsDefaultAndNoOthers) {
  Texts defaults;
  const SimulatorNodeParameters parameters;
  visitParameters(parameters, [&](const char* name, const auto& value) {
    defaults[name] = parameterText(value);
  });
  EXPECT_GT(defaults.size(), 30U);
  EXPECT_EQ(documentedDefaults(), defaults);
}

}  // namespace
}  // namespace racecar_mcl
