#include "racecar_mcl/localizer/foreign_parameters.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/parameter_text.h"

namespace racecar_mcl {
namespace {

using Texts = std::map<std::string, std::string>;
using Value = ForeignValue;

// Beams of a scan of the racecar's Hokuyo UST-10LX, which angle_step divides.
constexpr double kHokuyoBeams = 1081.0;

std::optional<double> numberIn(const Texts& texts, const std::string& name) {
  const auto found = texts.find(name);
  if (found == texts.end()) return std::nullopt;
  double value = 0.0;
  parseParameter(name, found->second, &value);
  return value;
}

std::string textIn(const Texts& texts, const std::string& name, const std::string& otherwise) {
  const auto found = texts.find(name);
  return found == texts.end() ? otherwise : found->second;
}

std::string withoutSlash(const std::string& frame) {
  return frame.rfind('/', 0) == 0 ? frame.substr(1) : frame;
}

/// The word of this package for a word of another one.
std::string translateWord(const std::string& name, const std::string& word) {
  static const std::map<std::string, Texts> kWords = {
      {"laser_model_type",
       {{"beam", "beam"},
        {"likelihood_field", "likelihood_field"},
        {"likelihood_field_prob", "likelihood_field"}}},
      {"odom_model_type",
       {{"diff", "differential"},
        {"diff-corrected", "differential"},
        {"omni", "differential"},
        {"omni-corrected", "differential"}}},
      {"tf_broadcast", {{"true", "map_to_odom"}, {"false", "off"}}},
      {"range_method",
       {{"bl", "bresenham"},
        {"rm", "distance_transform"},
        {"rmgpu", "simd"},
        {"cddt", "lut"},
        {"pcddt", "lut"},
        {"glt", "lut"}}}};
  const Texts& words = kWords.at(name);
  const auto found = words.find(word);
  if (found != words.end()) return found->second;
  std::string expected = "one of";
  for (const auto& [known, ours] : words) expected += " " + known;
  refuseParameter(name, word, expected);
}

/// The four fractions of the beam model, scaled to a sum of 1. Factors common to all beams cancel.
void combineFractions(const std::string& prefix, const Texts& defaults, const Texts& texts,
                      Texts* ours) {
  double sum = 0.0;
  bool given = false;
  Texts values;
  for (const char* kind : {"hit", "short", "max", "rand"}) {
    const std::string name = prefix + kind;
    given |= texts.count(name) > 0;
    values[kind] = textIn(texts, name, defaults.at(kind));
    sum += numberIn(values, kind).value();
  }
  if (!given) return;
  if (!(sum > 0.0)) refuseParameter(prefix + "hit", values["hit"], "a positive sum of fractions");
  for (const auto& [kind, text] : values) {
    (*ours)["alpha_" + kind] = parameterText(numberIn(values, kind).value() / sum);
  }
}

void combineAmcl(const Texts& texts, Texts* ours) {
  combineFractions("laser_z_",
                   {{"hit", "0.95"}, {"short", "0.1"}, {"max", "0.05"}, {"rand", "0.05"}}, texts,
                   ours);
  const double hit = numberIn(texts, "laser_z_hit").value_or(0.95);
  const double random = numberIn(texts, "laser_z_rand").value_or(0.05);
  if (texts.count("laser_z_hit") + texts.count("laser_z_rand") > 0) {
    (*ours)["z_rand"] = parameterText(random / (hit + random));
  }
  if (texts.count("initial_pose_x") + texts.count("initial_pose_y") +
          texts.count("initial_pose_a") >
      0) {
    (*ours)["initial_pose"] = textIn(texts, "initial_pose_x", "0") + " " +
                              textIn(texts, "initial_pose_y", "0") + " " +
                              textIn(texts, "initial_pose_a", "0");
  }
  // amcl takes the odometry from tf, and broadcasts its parent.
  ours->emplace("motion_from", "tf");
  ours->emplace("tf_mode", "map_to_odom");
}

void combineMit(const Texts& texts, Texts* ours) {
  combineFractions("z_", {{"hit", "0.75"}, {"short", "0.01"}, {"max", "0.07"}, {"rand", "0.12"}},
                   texts, ours);
  const double beams = std::round(kHokuyoBeams / numberIn(texts, "angle_step").value_or(18.0));
  if (texts.count("angle_step") > 0) (*ours)["num_beams_per_particle"] = parameterText(beams);
  if (const auto squash = numberIn(texts, "squash_factor")) {
    (*ours)["effective_beams"] = parameterText(beams / *squash);
  }
  ours->emplace("motion_model", "constant");
  ours->emplace("sensor_model", "beam");
}

}  // namespace

ForeignTranslation translateParameters(const std::string& origin, const Texts& texts) {
  const std::vector<std::string> origins = foreignOrigins();
  if (std::find(origins.begin(), origins.end(), origin) == origins.end()) {
    refuseParameter("compat", origin, "one of amcl lab5 mit_pf");
  }
  ForeignTranslation result;
  Texts given = texts;
  for (const ForeignParameter& foreign : foreignParameters()) {
    const auto found = texts.find(foreign.name);
    if (origin != foreign.origin || found == texts.end()) continue;
    given.erase(foreign.name);
    std::string& ours = result.parameters[foreign.ours];
    switch (foreign.value) {
      case Value::kCopied:
        ours = found->second;
        break;
      case Value::kStripped:
        ours = withoutSlash(found->second);
        break;
      case Value::kSquareRoot:
        ours = parameterText(std::sqrt(numberIn(texts, foreign.name).value()));
        break;
      case Value::kWord:
        ours = translateWord(foreign.name, found->second);
        break;
      case Value::kCombined:
        break;
      case Value::kNone:
        result.notes.push_back(std::string(foreign.name) + ": " + foreign.note);
        break;
    }
  }
  result.parameters.erase("");
  if (origin == "amcl") combineAmcl(texts, &result.parameters);
  if (origin == "mit_pf") combineMit(texts, &result.parameters);
  for (const auto& [name, text] : given) result.parameters[name] = text;
  return result;
}

}  // namespace racecar_mcl
