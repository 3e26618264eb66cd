#include "racecar_mcl/localizer/parameter_registry.h"

#include "localizer/enum_names.h"
#include "racecar_mcl/common/parameter_text.h"
#include "racecar_mcl/localizer/foreign_parameters.h"

namespace racecar_mcl {

namespace {

/// Calls visit(name, field) for every parameter that is rarely changed; names without the prefix
/// `expert/`.
template <typename Parameters, typename Visit>
void forEachExpertParameter(Parameters& p, const Visit& visit) {
  visit("min_effective_particles", p.filter.min_effective_particles);
  visit("resample_threshold", p.filter.resample_threshold);
  visit("resampling", p.filter.resampling);
  visit("estimate", p.filter.estimate);
  visit("initial_sigma", p.filter.initial_sigma);
  visit("regularization_updates", p.filter.regularization_updates);
  visit("scan_decorrelation_distance", p.filter.scan_decorrelation_distance);
  visit("bound_information", p.filter.bound_information);

  visit("deterministic", p.motion.deterministic);
  visit("constant_x_sigma", p.motion.constant_x_sigma);
  visit("constant_y_sigma", p.motion.constant_y_sigma);
  visit("constant_yaw_sigma", p.motion.constant_yaw_sigma);
  visit("rotation_noise_from_rotation", p.motion.rotation_noise_from_rotation);
  visit("rotation_noise_from_translation", p.motion.rotation_noise_from_translation);
  visit("translation_noise_from_translation", p.motion.translation_noise_from_translation);
  visit("translation_noise_from_rotation", p.motion.translation_noise_from_rotation);
  visit("position_noise_from_time", p.motion.position_noise_from_time);
  visit("yaw_noise_from_time", p.motion.yaw_noise_from_time);
  visit("slip_noise_from_speed", p.motion.slip_noise_from_speed);
  visit("slip_noise_from_acceleration", p.motion.slip_noise_from_acceleration);
  visit("translation_scale_error", p.motion.translation_scale_error);
  visit("curvature_error", p.motion.curvature_error);
  visit("rotation_scale_error", p.motion.rotation_scale_error);
  visit("max_odometry_extrapolation", p.odometry.max_odometry_extrapolation);
  visit("clock_jump", p.odometry.clock_jump);
  visit("calibration_distance", p.calibration.calibration_distance);
  visit("noise_adaptation", p.noise_adaptation);
  visit("slip_compensation", p.slip_compensation);

  visit("beam_layout", p.scan.beam_layout);
  visit("beam_box_aspect", p.scan.beam_box_aspect);
  visit("min_beams", p.scan.min_beams);
  visit("stationary_updates", p.stationary_updates);

  visit("field_max_range", p.sensor.field.field_max_range);
  visit("inside_wall_factor", p.sensor.field.inside_wall_factor);
  visit("unmapped_likelihood", p.sensor.field.unmapped_likelihood);
  visit("table_width", p.sensor.beam.table.table_width);
  visit("lidar_scale_to_map_scale", p.sensor.beam.lidar_scale_to_map_scale);
  visit("pixels_per_cell", p.sensor.beam.pixels_per_cell);
  visit("range_bias", p.range_bias.range_bias);
  visit("range_bias_distance", p.range_bias.range_bias_distance);

  visit("unknown_is", p.sensor.caster.unknown_is);
  visit("lut_spacing", p.sensor.caster.lut_spacing);
  visit("lut_directions", p.sensor.caster.lut_directions);
  visit("lut_memory", p.sensor.caster.lut_memory);

  visit("search_spacing", p.sensor.search.search_spacing);
  visit("search_yaw_spacing", p.sensor.search.search_yaw_spacing);
  visit("search_beams", p.sensor.search.search_beams);
  visit("search_max_range", p.sensor.search.search_max_range);
  visit("search_poses", p.sensor.search.search_poses);
  visit("lidar_odometry", p.lidar_odometry);

  visit("inlier_averaging_time", p.monitor.inlier_averaging_time);
  visit("degraded_deviations", p.monitor.degraded_deviations);
  visit("lost_conflict", p.monitor.lost_conflict);
  visit("localized_sigma", p.monitor.localized_sigma);
  visit("odometry_disagreement", p.monitor.odometry_disagreement);
}

/// Calls visit(name, field) for every parameter: the only mapping between names and fields.
template <typename Parameters, typename Visit>
void forEachParameter(Parameters& p, const Visit& visit) {
  visit("num_particles", p.filter.num_particles);
  visit("max_particles", p.filter.max_particles);
  visit("num_threads", p.filter.num_threads);

  visit("motion_model", p.motion.motion_model);
  visit("longitudinal_noise_from_translation", p.motion.longitudinal_noise_from_translation);
  visit("lateral_noise_from_translation", p.motion.lateral_noise_from_translation);
  visit("yaw_noise_from_translation", p.motion.yaw_noise_from_translation);
  visit("yaw_noise_from_rotation", p.motion.yaw_noise_from_rotation);
  visit("motion_from", p.odometry.motion_from);
  visit("max_odometry_gap", p.odometry.max_odometry_gap);

  visit("num_beams_per_particle", p.scan.num_beams_per_particle);
  visit("scan_field_of_view", p.scan.scan_field_of_view);
  visit("deskew", p.scan.deskew);
  visit("scan_direction", p.scan_direction);

  visit("sensor_model", p.sensor.sensor_model);
  visit("effective_beams", p.effective_beams);
  visit("field_scale", p.sensor.field.field_scale);
  visit("z_rand", p.sensor.field.z_rand);
  visit("alpha_hit", p.sensor.beam.table.alpha_hit);
  visit("alpha_short", p.sensor.beam.table.alpha_short);
  visit("alpha_max", p.sensor.beam.table.alpha_max);
  visit("alpha_rand", p.sensor.beam.table.alpha_rand);
  visit("sigma_hit", p.sensor.beam.table.sigma_hit);
  visit("distance_filter", p.distance_filter);

  visit("range_method", p.sensor.caster.range_method);
  visit("max_range", p.sensor.caster.max_range);

  visit("relocalization", p.relocalization);
  visit("integrity_risk", p.protection.integrity_risk);

  forEachExpertParameter(
      p, [&](const std::string& name, auto& field) { visit("expert/" + name, field); });
}

}  // namespace

std::map<std::string, std::string> parameterTexts(const LocalizerParameters& parameters) {
  std::map<std::string, std::string> texts;
  forEachParameter(parameters, [&](const std::string& name, const auto& field) {
    texts[name] = parameterText(field);
  });
  return texts;
}

std::map<std::string, std::string> parameterTypes() {
  std::map<std::string, std::string> types;
  const LocalizerParameters parameters;
  forEachParameter(parameters, [&](const std::string& name, const auto& field) {
    types[name] = parameterType(field);
  });
  return types;
}

bool needsNewMap(const LocalizerParameters& one, const LocalizerParameters& other) {
  const auto of_map = [](const LocalizerParameters& parameters) {
    LocalizerParameters map;
    map.sensor = parameters.sensor;
    // The exponent of the likelihood.
    map.effective_beams = parameters.effective_beams;
    map.scan.num_beams_per_particle = parameters.scan.num_beams_per_particle;
    return parameterTexts(map);
  };
  return of_map(one) != of_map(other);
}

void setParameter(const std::string& name, const std::string& text,
                  LocalizerParameters* parameters) {
  bool is_known = false;
  forEachParameter(*parameters,
                   [&](const std::string& known, const auto&) { is_known |= name == known; });
  const std::string hint = is_known ? "" : foreignHint(name);
  if (!hint.empty()) {
    throw ParameterError("there is no parameter '" + name + "'; " + hint + " (docs/migrating.md)");
  }
  setByName(name, text, [&](const auto& visit) { forEachParameter(*parameters, visit); });
}

}  // namespace racecar_mcl
