// Every parameter of the registry changes the result of a drive: none is read and then ignored.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "offline/wrong_course.h"
#include "racecar_mcl/localizer/parameter_registry.h"

namespace racecar_mcl {
namespace {

/// A parameter's value `name:=value`, after values that both drives have.
struct Change {
  std::string setting;
  std::vector<std::string> both = {};
};

std::string nameOf(const std::string& setting) { return setting.substr(0, setting.find(":=")); }

void set(const std::string& setting, LocalizerParameters* parameters) {
  setParameter(nameOf(setting), setting.substr(setting.find(":=") + 2), parameters);
}

/// All that the localizer says about a scan, with all digits.
void append(const ScanResult& result, const Localizer& localizer, std::ostream* text) {
  const LocalizationStatus& status = result.status;
  const PoseEstimate& estimate = result.update.estimate;
  *text << static_cast<int>(result.outcome) << ' ' << estimate.base_in_map.x << ' '
        << estimate.base_in_map.y << ' ' << estimate.base_in_map.yaw << ' ' << estimate.covariance
        << ' ' << result.update.effective_sample_size << ' ' << result.update.beams << ' '
        << result.update.particles << ' ' << static_cast<int>(status.state) << ' ' << status.reason
        << ' ' << status.inlier_ratio << ' ' << status.disagreement << ' ' << status.level.along
        << ' ' << status.level.across << ' ' << status.level.heading << ' ' << result.range_bias
        << ' ' << static_cast<int>(localizer.lidars().front().direction.isReversed()) << '\n';
}

/// The drive: wheel slip, silent odometry, a clock that is set back, odometry that says stop, a
/// covered lidar, a map without some walls, a kidnapping and a global start.
class ParameterEffect : public testing::Test {
 protected:
  std::string resultOf(const std::vector<std::string>& settings) {
    LocalizerParameters parameters;
    // So that a short drive has a stop and a clock that is set back.
    for (const char* setting : {"expert/stationary_updates:=5", "expert/clock_jump:=0.4"}) {
      set(setting, &parameters);
    }
    for (const std::string& setting : settings) set(setting, &parameters);
    Random random(3);
    auto [course, start, wrong] = loadWrongCourse(path_, "erased_walls", parameters, random);
    sim::SimulatorParameters simulator;
    simulator.odometry.slip = 0.3;
    simulator.lidar.beams = 541;
    SimulatedDrive drive(course, parameters, simulator, start, 3.0, 5);
    drive.localizer().initialize({start, Eigen::Matrix3d::Zero()});
    std::vector<Eigen::Index> fifty(50);
    for (std::size_t i = 0; i < 50; ++i) fifty[i] = static_cast<Eigen::Index>(10 * i);
    const double begin = drive.simulator().time();
    drive.on_odometry = [&](OdometrySample* sample) {
      const double seconds = sample->stamp - begin;
      sample->stamp -= seconds > 1.5 ? 0.5 : 0.0;
      if (seconds > 1.9 && seconds < 2.2) sample->twist = {};
      return !(seconds > 0.8 && seconds < 1.2) && !(seconds > 3.0 && seconds < 4.2);
    };
    drive.on_scan = [&](Scan* scan) {
      const double seconds = scan->stamp - begin;
      scan->stamp -= seconds > 1.5 ? 0.5 : 0.0;
      if (seconds > 2.3 && seconds < 2.4) *scan = takeBeams(*scan, fifty);
      return true;
    };
    std::ostringstream text;
    text.precision(17);
    const auto record = [&](const Observation& seen) {
      append(seen.result, drive.localizer(), &text);
    };
    drive.drive(2.5, record);
    drive.localizer().setMap(makeLocalizationMap(wrong.map, parameters));
    drive.drive(2.5, record);
    drive.simulator().place(sim::randomFreePose(*course.world, {}, random, 0.3));
    drive.localizer().setMap(course.map);
    drive.drive(1.5, record);
    drive.localizer().initializeGlobally();
    drive.drive(0.5, record);
    return text.str();
  }

  const std::string path_ = RACECAR_MCL_SOURCE_DIR "/maps/track.yaml";
};

const std::vector<std::string> kBeamModel = {"sensor_model:=beam"};

/// One changed value of every parameter.
const std::vector<Change>& changes() {
  static const std::vector<Change> all = {
      {"num_particles:=150"},
      {"max_particles:=10000"},
      {"motion_model:=differential"},
      {"longitudinal_noise_from_translation:=0.02"},
      {"lateral_noise_from_translation:=0.02"},
      {"yaw_noise_from_translation:=0.08"},
      {"yaw_noise_from_rotation:=0.1"},
      {"motion_from:=pose"},
      {"max_odometry_gap:=0.7"},
      {"num_beams_per_particle:=200"},
      {"scan_field_of_view:=4"},
      {"deskew:=false"},
      {"scan_direction:=reversed"},
      {"sensor_model:=beam"},
      {"effective_beams:=30"},
      {"field_scale:=0.06"},
      {"z_rand:=0.2"},
      {"sigma_hit:=4", kBeamModel},
      {"distance_filter:=true"},
      {"range_method:=bresenham", kBeamModel},
      {"max_range:=12", kBeamModel},
      {"relocalization:=off"},
      {"integrity_risk:=0.01"},
      {"expert/min_effective_particles:=0"},
      {"expert/resample_threshold:=0.9"},
      {"expert/resampling:=multinomial"},
      {"expert/estimate:=best"},
      {"expert/initial_sigma:=0.3"},
      {"expert/regularization_updates:=0"},
      {"expert/scan_decorrelation_distance:=0"},
      {"expert/bound_information:=false"},
      {"expert/deterministic:=true"},
      {"expert/constant_x_sigma:=0.08", {"motion_model:=constant"}},
      {"expert/constant_y_sigma:=0.08", {"motion_model:=constant"}},
      {"expert/constant_yaw_sigma:=0.06", {"motion_model:=constant"}},
      {"expert/rotation_noise_from_rotation:=0.4", {"motion_model:=differential"}},
      {"expert/rotation_noise_from_translation:=0.1", {"motion_model:=differential"}},
      {"expert/translation_noise_from_translation:=0.2", {"motion_model:=differential"}},
      {"expert/translation_noise_from_rotation:=0.04", {"motion_model:=differential"}},
      {"expert/position_noise_from_time:=0.02"},
      {"expert/yaw_noise_from_time:=0.03"},
      {"expert/slip_noise_from_speed:=0.03"},
      {"expert/slip_noise_from_acceleration:=0.03"},
      {"expert/translation_scale_error:=0.2"},
      {"expert/curvature_error:=0.05"},
      {"expert/rotation_scale_error:=0.08"},
      {"expert/max_odometry_extrapolation:=0.1"},
      {"expert/clock_jump:=0.6"},
      {"expert/calibration_distance:=10"},
      {"expert/noise_adaptation:=true"},
      {"expert/slip_compensation:=false"},
      {"expert/beam_layout:=even"},
      {"expert/beam_box_aspect:=4"},
      {"expert/min_beams:=60"},
      // A car that the odometry stops at once is held to slip.
      {"expert/stationary_updates:=40", {"expert/slip_compensation:=false"}},
      {"expert/field_max_range:=4"},
      {"expert/table_width:=150", kBeamModel},
      {"expert/lidar_scale_to_map_scale:=1.2", kBeamModel},
      {"expert/pixels_per_cell:=2", kBeamModel},
      {"expert/unmapped_likelihood:=0"},
      {"expert/range_bias:=0.02"},
      {"expert/range_bias_distance:=5"},
      {"expert/unknown_is:=occupied", kBeamModel},
      {"expert/lut_spacing:=0.05", {"sensor_model:=beam", "range_method:=lut"}},
      {"expert/lut_directions:=256", {"sensor_model:=beam", "range_method:=lut"}},
      {"expert/search_spacing:=0.4"},
      {"expert/search_yaw_spacing:=0.12"},
      {"expert/search_beams:=30"},
      {"expert/search_max_range:=4"},
      {"expert/search_poses:=200000"},
      {"expert/lidar_odometry:=false"},
      {"expert/inlier_averaging_time:=1"},
      {"expert/degraded_deviations:=0.5"},
      {"expert/lost_conflict:=1"},
      {"expert/localized_sigma:=0.02"},
      {"expert/odometry_disagreement:=0.01"}};
  return all;
}

// The first two change the time or the memory, not the result. The maps here have no blurred walls:
// likelihood_field_test.cpp. The others have the sum 1, so that none changes alone:
// beam_table_test.cpp.
const std::vector<std::string> kNotHere = {
    "num_threads", "expert/lut_memory", "expert/inside_wall_factor", "alpha_hit", "alpha_short",
    "alpha_max",   "alpha_rand"};

TEST_F(ParameterEffect, EveryParameterChangesTheResult) {
  std::map<std::vector<std::string>, std::string> unchanged;
  for (const Change& change : changes()) {
    if (unchanged.count(change.both) == 0) unchanged[change.both] = resultOf(change.both);
    std::vector<std::string> settings = change.both;
    settings.push_back(change.setting);
    EXPECT_TRUE(resultOf(settings) != unchanged[change.both]) << change.setting << " has no effect";
  }
}

TEST_F(ParameterEffect, TheDriveIsDeterministic) { EXPECT_EQ(resultOf({}), resultOf({})); }

TEST(ParameterEffects, HaveEveryParameterOfTheRegistry) {
  std::vector<std::string> tested = kNotHere;
  for (const Change& change : changes()) tested.push_back(nameOf(change.setting));
  for (const auto& [name, text] : parameterTexts({})) {
    EXPECT_EQ(std::count(tested.begin(), tested.end(), name), 1) << name;
  }
}

}  // namespace
}  // namespace racecar_mcl
