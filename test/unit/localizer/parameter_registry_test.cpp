#include "racecar_mcl/localizer/parameter_registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "racecar_mcl/common/errors.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

using Texts = std::map<std::string, std::string>;

std::string sourceFile(const std::string& path) {
  return std::string(RACECAR_MCL_SOURCE_DIR) + "/" + path;
}

std::string contentOf(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The lines `name: value  # comment`.
Texts flatYaml(const std::string& path) {
  Texts texts;
  std::istringstream lines(contentOf(path));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string name, value, rest;
    if (!(words >> name)) continue;
    EXPECT_TRUE(name.size() > 1 && name.back() == ':' && words >> value && !(words >> rest))
        << line;
    name.pop_back();
    EXPECT_TRUE(texts.emplace(name, value).second) << name << " appears twice";
  }
  return texts;
}

std::string messageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ParameterError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no ParameterError was thrown";
  return {};
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(DefaultConfiguration, RepeatsTheDefaultsNameForNameAndValueForValue) {
  const Texts in_file = flatYaml(sourceFile("config/default.yaml"));
  const Texts in_code = parameterTexts(LocalizerParameters{});
  for (const auto& [name, value] : in_code) {
    const auto found = in_file.find(name);
    EXPECT_EQ(found == in_file.end() ? "missing" : found->second, value)
        << "config/default.yaml should say '" << name << ": " << value << "'";
  }
  for (const auto& [name, value] : in_file) {
    EXPECT_EQ(in_code.count(name), 1u) << "config/default.yaml names an unknown '" << name << "'";
  }
}

TEST(DefaultConfiguration, CanBeRead) {
  LocalizerParameters parameters;
  parameters.filter.num_particles = 5;
  parameters.scan.deskew = !parameters.scan.deskew;
  readParameterFile(sourceFile("config/default.yaml"), &parameters);
  EXPECT_EQ(parameterTexts(parameters), parameterTexts(LocalizerParameters{}));
}

TEST(DefaultConfiguration, IsValid) { EXPECT_NO_THROW(validate(LocalizerParameters{})); }

TEST(ReportConfiguration, HasTheReportsConstants) {
  LocalizerParameters p;
  readParameterFile(sourceFile("config/report.yaml"), &p);
  EXPECT_NO_THROW(validate(p));
  EXPECT_EQ(p.filter.num_particles, 200);
  EXPECT_EQ(p.filter.initial_sigma, 0.5);
  EXPECT_EQ(p.filter.resample_threshold, 1.0);
  EXPECT_EQ(p.filter.estimate, EstimateFrom::kMean);
  EXPECT_EQ(p.filter.regularization_updates, 0);
  EXPECT_EQ(p.motion.motion_model, MotionNoise::kConstant);
  EXPECT_FALSE(p.motion.deterministic);
  EXPECT_EQ(p.motion.constant_x_sigma, 0.04);
  EXPECT_EQ(p.motion.constant_y_sigma, 0.04);
  EXPECT_EQ(p.motion.constant_yaw_sigma, 0.03);
  EXPECT_EQ(p.scan.num_beams_per_particle, 100);
  EXPECT_EQ(p.scan.scan_field_of_view, 4.71);
  EXPECT_EQ(p.sensor.sensor_model, SensorModelType::kBeam);
  EXPECT_EQ(p.sensor.beam.table.alpha_hit, 0.74);
  EXPECT_EQ(p.sensor.beam.table.alpha_short, 0.07);
  EXPECT_EQ(p.sensor.beam.table.alpha_max, 0.07);
  EXPECT_EQ(p.sensor.beam.table.alpha_rand, 0.12);
  EXPECT_EQ(p.sensor.beam.table.sigma_hit, 8.0);
  EXPECT_EQ(p.sensor.beam.table.table_width, 201);
  EXPECT_EQ(p.sensor.beam.lidar_scale_to_map_scale, 1.0);
  EXPECT_EQ(p.sensor.beam.pixels_per_cell, 1.0);
  EXPECT_NEAR(p.effective_beams, 100.0 / 2.2, 1e-3);
  EXPECT_EQ(p.odometry.motion_from, MotionFrom::kTwist);
}

/// The text between two marks after a position, which is moved past the second mark.
std::string between(const std::string& text, const std::string& from, const std::string& to,
                    std::size_t* position) {
  const std::size_t start = text.find(from, *position);
  const std::size_t end = start == std::string::npos ? start : text.find(to, start + from.size());
  *position = end == std::string::npos ? end : end + to.size();
  return end == std::string::npos ? ""
                                  : text.substr(start + from.size(), end - start - from.size());
}

/// The rows of the tables in docs/parameters.md: | `name` | `default` | ...
Texts documentedDefaults() {
  Texts texts;
  std::istringstream lines(contentOf(sourceFile("docs/parameters.md")));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    std::size_t position = 0;
    const std::string name = between(line, "| `", "` |", &position);
    const std::string value = between(line, " `", "` |", &position);
    EXPECT_NE(position, std::string::npos) << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), '|'), 7) << line;
    EXPECT_TRUE(texts.emplace(name, value).second) << name << " appears twice";
  }
  return texts;
}

TEST(ParameterPage, ListsEveryParameterWithItsDefault) {
  const Texts documented = documentedDefaults();
  for (const auto& [name, value] : parameterTexts(LocalizerParameters{})) {
    const auto found = documented.find(name);
    EXPECT_EQ(found == documented.end() ? "missing" : found->second, value)
        << "docs/parameters.md should hold '| `" << name << "` | `" << value << "` | ...'";
  }
}

TEST(ParameterPage, ListsEveryParameterOfTheNodeAndNoOthers) {
  const std::string source = contentOf(sourceFile("src/ros/localization/node_parameters.cpp"));
  Texts known = parameterTexts(LocalizerParameters{});
  const Texts documented = documentedDefaults();
  std::size_t position = 0;
  for (;;) {
    const std::string name = between(source, "visit(\"", "\"", &position);
    if (position == std::string::npos) break;
    EXPECT_EQ(documented.count(name), 1u) << "docs/parameters.md does not name '" << name << "'";
    known[name] = "";
  }
  EXPECT_EQ(known.count("tf_mode"), 1u);
  for (const auto& [name, value] : documented) {
    EXPECT_EQ(known.count(name), 1u) << "docs/parameters.md names an unknown '" << name << "'";
  }
}

TEST(Parameters, EveryOneCanBeSetFromItsOwnText) {
  const LocalizerParameters defaults;
  for (const auto& [name, value] : parameterTexts(defaults)) {
    LocalizerParameters parameters;
    EXPECT_NO_THROW(setParameter(name, value, &parameters)) << name;
    EXPECT_EQ(parameterTexts(parameters), parameterTexts(defaults)) << name;
  }
}

TEST(Parameters, EveryOneChangesOnlyItself) {
  for (const auto& [name, value] : parameterTexts(LocalizerParameters{})) {
    Texts expected = parameterTexts(LocalizerParameters{});
    bool changed = false;
    for (const char* other :
         {"0.625", "77", "true", "false", "best", "constant", "multinomial", "occupied", "even",
          "listed", "pose", "beam", "likelihood_field", "bresenham"}) {
      LocalizerParameters parameters;
      try {
        setParameter(name, other, &parameters);
      } catch (const ParameterError&) {
        continue;
      }
      const Texts texts = parameterTexts(parameters);
      if (texts.at(name) == value) continue;
      changed = true;
      // YAML reads a bare off as false.
      expected[name] = name == "relocalization" && other == std::string("false") ? "off" : other;
      EXPECT_EQ(texts, expected);
    }
    EXPECT_TRUE(changed) << name;
  }
}

TEST(Parameters, AnUnknownNameSuggestsTheNearest) {
  LocalizerParameters parameters;
  const auto messageFor = [&](const std::string& name) {
    return messageOf([&] { setParameter(name, "1", &parameters); });
  };
  EXPECT_TRUE(holds(messageFor("num_particle"), "'num_particles'"));
  EXPECT_TRUE(holds(messageFor("alfa_hit"), "'alpha_hit'"));
  EXPECT_TRUE(holds(messageFor("Sigma_Hit"), "'sigma_hit'"));
  EXPECT_TRUE(holds(messageFor("alfa_hit"), "'alfa_hit'"));
  EXPECT_TRUE(holds(messageFor("clock_jump"), "'expert/clock_jump'"));
}

TEST(Parameters, AnIllTypedTextIsRejectedWithTheExpectedType) {
  const struct {
    const char* name;
    const char* text;
    const char* expected;
  } bad[] = {{"num_particles", "many", "whole number"},
             {"num_particles", "200.5", "whole number"},
             {"num_particles", "", "whole number"},
             {"num_particles", "99999999999", "whole number"},
             {"sigma_hit", "8,0", "a number"},
             {"sigma_hit", "8 px", "a number"},
             {"deskew", "maybe", "true or false"},
             {"deskew", "2", "true or false"},
             {"motion_model", "tank", "constant differential ackermann"},
             {"expert/estimate", "Mean", "mean best cluster"},
             {"expert/unknown_is", "true", "free occupied"}};
  for (const auto& [name, text, expected] : bad) {
    LocalizerParameters parameters;
    const std::string message =
        messageOf([&, n = name, t = text] { setParameter(n, t, &parameters); });
    EXPECT_TRUE(holds(message, name)) << message;
    EXPECT_TRUE(holds(message, text)) << message;
    EXPECT_TRUE(holds(message, expected)) << message;
    EXPECT_EQ(parameterTexts(parameters), parameterTexts(LocalizerParameters{}));
  }
}

TEST(Parameters, AFlagCanBeANumber) {
  LocalizerParameters parameters;
  for (const char* no : {"0", "false", "False", "NO", "n", "off"}) {
    parameters.scan.deskew = true;
    setParameter("deskew", no, &parameters);
    EXPECT_FALSE(parameters.scan.deskew) << no;
  }
  for (const char* yes : {"1", "true", "TRUE", "Yes", "y", "On"}) {
    parameters.scan.deskew = false;
    setParameter("deskew", yes, &parameters);
    EXPECT_TRUE(parameters.scan.deskew) << yes;
  }
}

TEST(ParameterFile, SetsTheParametersInIt) {
  const TemporaryDirectory directory;
  LocalizerParameters parameters;
  readParameterFile(directory.write("a.yaml",
                                    "# a comment\nnum_particles: 321\n"
                                    "motion_model: constant   # another\n"
                                    "sigma_hit: 1.5e-1\ndeskew: no\n"),
                    &parameters);
  EXPECT_EQ(parameters.filter.num_particles, 321);
  EXPECT_EQ(parameters.motion.motion_model, MotionNoise::kConstant);
  EXPECT_EQ(parameters.sensor.beam.table.sigma_hit, 0.15);
  EXPECT_FALSE(parameters.scan.deskew);
}

TEST(ParameterFile, AcceptsExpertParametersAsASection) {
  const TemporaryDirectory directory;
  LocalizerParameters parameters;
  readParameterFile(directory.write("a.yaml", "expert/min_beams: 7\nexpert:\n  clock_jump: 2\n"),
                    &parameters);
  EXPECT_EQ(parameters.scan.min_beams, 7);
  EXPECT_EQ(parameters.odometry.clock_jump, 2.0);
}

TEST(ParameterFile, AnEmptyOneSetsNothing) {
  const TemporaryDirectory directory;
  LocalizerParameters parameters;
  readParameterFile(directory.write("a.yaml", "# nothing but a comment\n"), &parameters);
  EXPECT_EQ(parameterTexts(parameters), parameterTexts(LocalizerParameters{}));
}

TEST(ParameterFile, ABadOneIsReportedWithItsLineAndChangesNothing) {
  const TemporaryDirectory directory;
  const struct {
    const char* content;
    const char* said;
  } bad[] = {{"num_particles: 50\nnum_partikles: 5\n", "line 2"},
             {"num_particles: 50\n\n\nsigma_hit: wide\n", "line 4"},
             {"num_particles: 50\nsigma_hit: [1, 2]\n", "line 2"},
             {"num_particles: 50\nsigma_hit: {a: 1}\n", "line 2"},
             {"num_particles: 50\nsigma_hit:\n", "line 2"},
             {"num_particles: 50\n[1, 2]: 3\n", "line 2"},
             {"- num_particles\n- sigma_hit\n", "mapping"},
             {"num_particles\n", "mapping"},
             {"num_particles: [50\n", "not YAML"},
             {"a: b: c\n", "not YAML"}};
  for (const auto& [content, said] : bad) {
    const std::string path = directory.write("bad.yaml", content);
    LocalizerParameters parameters;
    const std::string message = messageOf([&] { readParameterFile(path, &parameters); });
    EXPECT_TRUE(holds(message, path)) << message;
    EXPECT_TRUE(holds(message, said)) << message;
    EXPECT_EQ(parameterTexts(parameters), parameterTexts(LocalizerParameters{}));
  }
}

TEST(ParameterFile, AMissingOneIsReported) {
  const TemporaryDirectory directory;
  LocalizerParameters parameters;
  const std::string missing = (directory.path() / "missing.yaml").string();
  EXPECT_TRUE(holds(messageOf([&] { readParameterFile(missing, &parameters); }), missing));
  const std::string folder = directory.path().string();
  EXPECT_TRUE(holds(messageOf([&] { readParameterFile(folder, &parameters); }), folder));
}

}  // namespace
}  // namespace racecar_mcl
