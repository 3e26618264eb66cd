#include "racecar_mcl/parameters.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {
namespace {

// The words for each enumeration, in the order of its values.
template <typename Enum>
std::vector<std::string> wordsOf();
template <>
std::vector<std::string> wordsOf<MotionNoise>() {
  return {"constant", "differential", "ackermann"};
}
template <>
std::vector<std::string> wordsOf<ResamplingMethod>() {
  return {"systematic", "multinomial"};
}
template <>
std::vector<std::string> wordsOf<EstimateFrom>() {
  return {"mean", "best", "cluster"};
}
template <>
std::vector<std::string> wordsOf<UnknownIs>() {
  return {"free", "occupied"};
}
template <>
std::vector<std::string> wordsOf<SensorModel>() {
  return {"beam", "likelihood_field"};
}
template <>
std::vector<std::string> wordsOf<MotionFrom>() {
  return {"twist", "pose", "tf"};
}

template <>
std::vector<std::string> wordsOf<BeamLayout>() {
  return {"even", "boxed"};
}
template <>
std::vector<std::string> wordsOf<SweepOrderFrom>() {
  return {"learned", "listed", "reversed"};
}

/// Calls visit(name, field) for every parameter: the one place where names and fields meet.
template <typename Parameters, typename Visit>
void forEachParameter(Parameters& p, Visit&& visit) {
  visit("num_particles", p.filter.num_particles);
  visit("global_particles", p.filter.global_particles);
  visit("resample_threshold", p.filter.resample_threshold);
  visit("min_effective_particles", p.filter.min_effective_particles);
  visit("resampling", p.filter.resampling);
  visit("estimate", p.filter.estimate);
  visit("initial_sigma", p.filter.initial_sigma);
  visit("settling_updates", p.filter.settling_updates);
  visit("news_distance", p.filter.news_distance);
  visit("num_threads", p.filter.num_threads);

  visit("motion_model", p.motion.motion_model);
  visit("deterministic", p.motion.deterministic);
  visit("constant_x_sigma", p.motion.constant_x_sigma);
  visit("constant_y_sigma", p.motion.constant_y_sigma);
  visit("constant_yaw_sigma", p.motion.constant_yaw_sigma);
  visit("turn_per_turn", p.motion.turn_per_turn);
  visit("turn_per_metre", p.motion.turn_per_metre);
  visit("drive_per_metre", p.motion.drive_per_metre);
  visit("drive_per_turn", p.motion.drive_per_turn);
  visit("along_per_metre", p.motion.along_per_metre);
  visit("across_per_metre", p.motion.across_per_metre);
  visit("yaw_per_metre", p.motion.yaw_per_metre);
  visit("yaw_per_radian", p.motion.yaw_per_radian);
  visit("position_per_second", p.motion.position_per_second);
  visit("yaw_per_second", p.motion.yaw_per_second);
  visit("slip_per_acceleration", p.motion.slip_per_acceleration);
  visit("scale_error", p.motion.scale_error);
  visit("curvature_error", p.motion.curvature_error);
  visit("turn_scale_error", p.motion.turn_scale_error);

  visit("num_beams_per_particle", p.num_beams_per_particle);
  visit("scan_field_of_view", p.scan_field_of_view);
  visit("beam_layout", p.beam_layout);
  visit("beam_box_aspect", p.beam_box_aspect);
  visit("min_beams", p.min_beams);
  visit("global_search", p.global_search);
  visit("deskew", p.deskew);
  visit("sweep_order", p.sweep_order);
  visit("reject_short_returns", p.reject_short_returns);
  visit("parked_updates", p.parked_updates);

  visit("sensor_model", p.sensor.sensor_model);
  visit("map_error_distance", p.map_error_distance);
  visit("field_sigma", p.sensor.field.field_sigma);
  visit("field_rand", p.sensor.field.field_rand);
  visit("field_max_range", p.sensor.field.field_max_range);
  visit("field_squash", p.sensor.field.field_squash);
  visit("field_inside", p.sensor.field.field_inside);

  visit("bound_information", p.filter.bound_information);
  visit("lidar_odometry", p.lidar_odometry);
  visit("second_opinion", p.second_opinion);
  visit("recovery", p.recovery);
  visit("verdict_time", p.verdict.verdict_time);
  visit("degraded_deviations", p.verdict.degraded_deviations);
  visit("lost_conflict", p.verdict.lost_conflict);
  visit("localized_sigma", p.verdict.localized_sigma);
  visit("odometry_disagreement", p.verdict.odometry_disagreement);
  visit("protection_risk", p.protection.protection_risk);

  visit("search_spacing", p.sensor.search.search_spacing);
  visit("search_yaw_spacing", p.sensor.search.search_yaw_spacing);
  visit("search_beams", p.sensor.search.search_beams);
  visit("search_max_range", p.sensor.search.search_max_range);
  visit("search_poses", p.sensor.search.search_poses);

  visit("alpha_hit", p.sensor.beam.table.alpha_hit);
  visit("alpha_short", p.sensor.beam.table.alpha_short);
  visit("alpha_max", p.sensor.beam.table.alpha_max);
  visit("alpha_rand", p.sensor.beam.table.alpha_rand);
  visit("sigma_hit", p.sensor.beam.table.sigma_hit);
  visit("table_width", p.sensor.beam.table.table_width);
  visit("lidar_scale_to_map_scale", p.sensor.beam.lidar_scale_to_map_scale);
  visit("pixels_per_cell", p.sensor.beam.pixels_per_cell);
  visit("squash_factor", p.sensor.beam.squash_factor);

  visit("range_method", p.sensor.caster.range_method);
  visit("max_range", p.sensor.caster.max_range);
  visit("unknown_is", p.sensor.caster.unknown_is);
  visit("panorama_spacing", p.sensor.caster.panorama_spacing);
  visit("panorama_directions", p.sensor.caster.panorama_directions);
  visit("panorama_memory", p.sensor.caster.panorama_memory);

  visit("motion_from", p.odometry.motion_from);
  visit("max_odometry_gap", p.odometry.max_odometry_gap);
  visit("max_odometry_extrapolation", p.odometry.max_odometry_extrapolation);
  visit("clock_jump", p.odometry.clock_jump);
  visit("calibration_distance", p.calibration.calibration_distance);
  visit("range_bias", p.range_bias.range_bias);
  visit("range_bias_distance", p.range_bias.range_bias_distance);
  visit("noise_adaptation", p.noise_adaptation);
}

[[noreturn]] void refuse(const std::string& name, const std::string& text,
                         const std::string& expected) {
  throw ParameterError(name + " is '" + text + "'; expected " + expected);
}

void parse(const std::string& name, const YAML::Node& node, double* value) {
  try {
    *value = node.as<double>();
  } catch (const YAML::Exception&) {
    refuse(name, node.Scalar(), "a number");
  }
}

void parse(const std::string& name, const YAML::Node& node, int* value) {
  try {
    *value = node.as<int>();
  } catch (const YAML::Exception&) {
    refuse(name, node.Scalar(), "a whole number");
  }
}

void parse(const std::string& name, const YAML::Node& node, bool* value) {
  // As roslaunch and XML-RPC write it as well.
  if (node.Scalar() == "1" || node.Scalar() == "0") {
    *value = node.Scalar() == "1";
    return;
  }
  try {
    *value = node.as<bool>();
  } catch (const YAML::Exception&) {
    refuse(name, node.Scalar(), "true or false");
  }
}

void parse(const std::string& /*name*/, const YAML::Node& node, std::string* value) {
  *value = node.Scalar();
}

template <typename Enum>
void parse(const std::string& name, const YAML::Node& node, Enum* value) {
  const std::vector<std::string> words = wordsOf<Enum>();
  const auto found = std::find(words.begin(), words.end(), node.Scalar());
  if (found == words.end()) {
    std::string expected = "one of";
    for (const std::string& word : words) expected += " " + word;
    refuse(name, node.Scalar(), expected);
  }
  *value = static_cast<Enum>(found - words.begin());
}

std::string write(double value) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::digits10);
  text << value;
  return text.str();
}
std::string write(int value) { return std::to_string(value); }
std::string write(bool value) { return value ? "true" : "false"; }
std::string write(const std::string& value) { return value; }
template <typename Enum>
std::string write(Enum value) {
  return wordsOf<Enum>()[static_cast<std::size_t>(value)];
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

void setFromNode(const std::string& name, const YAML::Node& node, LocalizerParameters* parameters) {
  if (!node.IsScalar()) throw ParameterError(name + " must be a single value");
  bool found = false;
  std::string nearest;
  std::size_t nearest_distance = std::numeric_limits<std::size_t>::max();
  forEachParameter(*parameters, [&](const char* known, auto& field) {
    if (name == known) {
      parse(name, node, &field);
      found = true;
    }
    const std::size_t away = editDistance(name, known);
    if (away < nearest_distance) {
      nearest_distance = away;
      nearest = known;
    }
  });
  if (!found) {
    throw ParameterError("there is no parameter '" + name + "'; did you mean '" + nearest + "'?");
  }
}

}  // namespace

std::map<std::string, std::string> parameterTexts(const LocalizerParameters& parameters) {
  std::map<std::string, std::string> texts;
  forEachParameter(parameters,
                   [&](const char* name, const auto& field) { texts[name] = write(field); });
  return texts;
}

void setParameter(const std::string& name, const std::string& text,
                  LocalizerParameters* parameters) {
  setFromNode(name, YAML::Node(text), parameters);
}

void readParameterFile(const std::string& path, LocalizerParameters* parameters) {
  // A folder opens like a file and reads like an empty one.
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw ParameterError(path + ": expected a file");
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
  for (const auto& entry : file) {
    try {
      setFromNode(entry.first.as<std::string>(), entry.second, &read);
    } catch (const std::exception& error) {
      throw ParameterError(path + ", line " + std::to_string(entry.first.Mark().line + 1) + ": " +
                           error.what());
    }
  }
  *parameters = read;
}

}  // namespace racecar_mcl
