// The table of the parameters of other localizers, from their public documentation.
#include "racecar_mcl/localizer/foreign_parameters.h"

namespace racecar_mcl {

const std::vector<ForeignParameter>& foreignParameters() {
  static const std::vector<ForeignParameter> kTable = {
      {"amcl", "min_particles", "num_particles", ForeignValue::kCopied, ""},
      {"amcl", "max_particles", "max_particles", ForeignValue::kCopied, ""},
      {"amcl", "kld_err", "", ForeignValue::kNone, "fixed"},
      {"amcl", "kld_z", "", ForeignValue::kNone, "fixed"},
      {"amcl", "update_min_d", "", ForeignValue::kNone, "every scan is used"},
      {"amcl", "update_min_a", "", ForeignValue::kNone, "every scan is used"},
      {"amcl", "resample_interval", "", ForeignValue::kNone, "set expert/resample_threshold"},
      {"amcl", "selective_resampling", "", ForeignValue::kNone,
       "always; set expert/resample_threshold"},
      {"amcl", "transform_tolerance", "transform_tolerance", ForeignValue::kCopied, ""},
      {"amcl", "recovery_alpha_slow", "", ForeignValue::kNone, "set relocalization"},
      {"amcl", "recovery_alpha_fast", "", ForeignValue::kNone, "set relocalization"},
      {"amcl", "initial_pose_x", "initial_pose", ForeignValue::kCombined, ""},
      {"amcl", "initial_pose_y", "initial_pose", ForeignValue::kCombined, ""},
      {"amcl", "initial_pose_a", "initial_pose", ForeignValue::kCombined, ""},
      {"amcl", "initial_cov_xx", "", ForeignValue::kNone, "set expert/initial_sigma"},
      {"amcl", "initial_cov_yy", "", ForeignValue::kNone, "set expert/initial_sigma"},
      {"amcl", "initial_cov_aa", "", ForeignValue::kNone, "set expert/initial_sigma"},
      {"amcl", "gui_publish_rate", "", ForeignValue::kNone, "set visualization_rate"},
      {"amcl", "save_pose_rate", "", ForeignValue::kNone,
       "set last_pose_file, and remove initial_pose_* from the file"},
      {"amcl", "std_warn_level_x", "", ForeignValue::kNone, "see pf/status"},
      {"amcl", "std_warn_level_y", "", ForeignValue::kNone, "see pf/status"},
      {"amcl", "std_warn_level_yaw", "", ForeignValue::kNone, "see pf/status"},
      {"amcl", "force_update_after_initialpose", "", ForeignValue::kNone, "every scan is used"},
      {"amcl", "force_update_after_set_map", "", ForeignValue::kNone, "every scan is used"},
      {"amcl", "restore_defaults", "", ForeignValue::kNone, "not needed"},
      {"amcl", "beam_skip_error_threshold_", "", ForeignValue::kNone, "set distance_filter"},
      {"amcl", "use_map_topic", "", ForeignValue::kNone, "the map is always a topic"},
      {"amcl", "first_map_only", "", ForeignValue::kNone, "a new map replaces the old one"},
      {"amcl", "laser_min_range", "", ForeignValue::kNone, "that of the scan is used"},
      {"amcl", "laser_max_range", "", ForeignValue::kNone, "that of the scan is used"},
      {"amcl", "laser_max_beams", "num_beams_per_particle", ForeignValue::kCopied, ""},
      {"amcl", "laser_z_hit", "alpha_hit", ForeignValue::kCombined, ""},
      {"amcl", "laser_z_short", "alpha_short", ForeignValue::kCombined, ""},
      {"amcl", "laser_z_max", "alpha_max", ForeignValue::kCombined, ""},
      {"amcl", "laser_z_rand", "alpha_rand", ForeignValue::kCombined, ""},
      {"amcl", "laser_sigma_hit", "", ForeignValue::kNone,
       "set sigma_hit to the value divided by the resolution of the map, or field_scale"},
      {"amcl", "laser_lambda_short", "", ForeignValue::kNone, "fixed by the expected range"},
      {"amcl", "laser_likelihood_max_dist", "", ForeignValue::kNone, "not needed"},
      {"amcl", "laser_model_type", "sensor_model", ForeignValue::kWord, ""},
      {"amcl", "do_beamskip", "", ForeignValue::kNone, "set distance_filter"},
      {"amcl", "beam_skip_distance", "", ForeignValue::kNone, "set distance_filter"},
      {"amcl", "beam_skip_threshold", "", ForeignValue::kNone, "set distance_filter"},
      {"amcl", "beam_skip_error_threshold", "", ForeignValue::kNone, "set distance_filter"},
      {"amcl", "odom_model_type", "motion_model", ForeignValue::kWord, ""},
      {"amcl", "odom_alpha1", "expert/rotation_noise_from_rotation", ForeignValue::kSquareRoot, ""},
      {"amcl", "odom_alpha2", "expert/rotation_noise_from_translation", ForeignValue::kSquareRoot,
       ""},
      {"amcl", "odom_alpha3", "expert/translation_noise_from_translation",
       ForeignValue::kSquareRoot, ""},
      {"amcl", "odom_alpha4", "expert/translation_noise_from_rotation", ForeignValue::kSquareRoot,
       ""},
      {"amcl", "odom_alpha5", "", ForeignValue::kNone, "cars do not move sideways"},
      {"amcl", "odom_frame_id", "odom_frame", ForeignValue::kStripped, ""},
      {"amcl", "base_frame_id", "particle_filter_frame", ForeignValue::kStripped, ""},
      {"amcl", "global_frame_id", "map_frame", ForeignValue::kStripped, ""},
      {"amcl", "tf_broadcast", "tf_mode", ForeignValue::kWord, ""},

      {"lab5", "num_particles", "num_particles", ForeignValue::kCopied, ""},
      {"lab5", "num_beams_per_particle", "num_beams_per_particle", ForeignValue::kCopied, ""},
      {"lab5", "scan_field_of_view", "scan_field_of_view", ForeignValue::kCopied, ""},
      {"lab5", "particle_filter_frame", "particle_filter_frame", ForeignValue::kStripped, ""},
      {"lab5", "deterministic", "expert/deterministic", ForeignValue::kCopied, ""},
      {"lab5", "lidar_scale_to_map_scale", "expert/lidar_scale_to_map_scale", ForeignValue::kCopied,
       ""},
      {"lab5", "scan_theta_discretization", "", ForeignValue::kNone,
       "set expert/lut_directions for lut"},
      {"lab5", "map_topic", "", ForeignValue::kNone, "remap map"},
      {"lab5", "scan_topic", "", ForeignValue::kNone, "argument scan_topic of localize.launch"},
      {"lab5", "odom_topic", "", ForeignValue::kNone, "argument odom_topic of localize.launch"},

      {"mit_pf", "max_particles", "num_particles", ForeignValue::kCopied, ""},
      {"mit_pf", "angle_step", "num_beams_per_particle", ForeignValue::kCombined, ""},
      {"mit_pf", "squash_factor", "effective_beams", ForeignValue::kCombined, ""},
      {"mit_pf", "range_method", "range_method", ForeignValue::kWord, ""},
      {"mit_pf", "z_hit", "alpha_hit", ForeignValue::kCombined, ""},
      {"mit_pf", "z_short", "alpha_short", ForeignValue::kCombined, ""},
      {"mit_pf", "z_max", "alpha_max", ForeignValue::kCombined, ""},
      {"mit_pf", "z_rand", "alpha_rand", ForeignValue::kCombined, ""},
      {"mit_pf", "sigma_hit", "sigma_hit", ForeignValue::kCopied, ""},
      {"mit_pf", "motion_dispersion_x", "expert/constant_x_sigma", ForeignValue::kCopied, ""},
      {"mit_pf", "motion_dispersion_y", "expert/constant_y_sigma", ForeignValue::kCopied, ""},
      {"mit_pf", "motion_dispersion_theta", "expert/constant_yaw_sigma", ForeignValue::kCopied, ""},
      {"mit_pf", "max_range", "", ForeignValue::kNone, "set expert/table_width to cells plus 1"},
      {"mit_pf", "theta_discretization", "", ForeignValue::kNone,
       "set expert/lut_directions for lut"},
      {"mit_pf", "rangelib_variant", "", ForeignValue::kNone, "not needed"},
      {"mit_pf", "fine_timing", "", ForeignValue::kNone, "see /diagnostics"},
      {"mit_pf", "publish_odom", "", ForeignValue::kNone, "always"},
      {"mit_pf", "viz", "", ForeignValue::kNone, "if there are subscribers"},
      {"mit_pf", "max_viz_particles", "", ForeignValue::kNone, "fixed"},
      {"mit_pf", "scan_topic", "", ForeignValue::kNone, "argument scan_topic of localize.launch"},
      {"mit_pf", "odometry_topic", "", ForeignValue::kNone,
       "argument odom_topic of localize.launch"},
  };
  return kTable;
}

std::vector<std::string> foreignOrigins() { return {"amcl", "lab5", "mit_pf"}; }

std::string foreignHint(const std::string& name) {
  for (const ForeignParameter& foreign : foreignParameters()) {
    if (name != foreign.name) continue;
    const std::string of = std::string(" of ") + foreign.origin + " ";
    if (*foreign.ours) return "that" + of + "is '" + foreign.ours + "' here";
    return "that" + of + "has no counterpart: " + foreign.note;
  }
  return "";
}

}  // namespace racecar_mcl
