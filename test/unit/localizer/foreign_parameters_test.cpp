#include "racecar_mcl/localizer/foreign_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <set>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/parameter_registry.h"

namespace racecar_mcl {
namespace {

using Texts = std::map<std::string, std::string>;

const std::set<std::string> kNodeParameters = {
    "map_frame", "odom_frame",          "particle_filter_frame",
    "tf_mode",   "transform_tolerance", "initial_pose"};

/// The parameters of the localizer among these, applied to the defaults and validated.
LocalizerParameters applied(const Texts& texts) {
  LocalizerParameters parameters;
  for (const auto& [name, text] : texts) {
    if (kNodeParameters.count(name) == 0) setParameter(name, text, &parameters);
  }
  validate(parameters);
  return parameters;
}

TEST(ForeignParameters, EveryCounterpartExistsAndEveryOtherHasANote) {
  const Texts known = parameterTexts(LocalizerParameters{});
  std::set<std::string> names;
  for (const ForeignParameter& foreign : foreignParameters()) {
    const std::string ours = foreign.ours;
    EXPECT_TRUE(names.insert(std::string(foreign.origin) + " " + foreign.name).second)
        << foreign.name << " appears twice";
    EXPECT_TRUE(ours.empty() || known.count(ours) + kNodeParameters.count(ours) == 1) << ours;
    EXPECT_EQ(ours.empty(), foreign.value == ForeignValue::kNone) << foreign.name;
    EXPECT_EQ(ours.empty(), *foreign.note != '\0') << foreign.name;
  }
}

TEST(ForeignParameters, ThePageHasTheTableRowForRow) {
  std::ifstream file(std::string(RACECAR_MCL_SOURCE_DIR) + "/docs/migrating.md");
  ASSERT_TRUE(file);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  std::size_t rows = 0;
  for (const ForeignParameter& foreign : foreignParameters()) {
    const std::string ours = foreign.ours;
    const std::string row = std::string("| `") + foreign.name + "` | " +
                            (ours.empty() ? "none" : "`" + ours + "`") + " | ";
    EXPECT_NE(page.find(row), std::string::npos) << "docs/migrating.md lacks the row " << row;
    ++rows;
  }
  EXPECT_GT(rows, 60U);
}

TEST(ForeignParameters, AnUnknownNameGetsTheCounterpartInsteadOfAGuess) {
  LocalizerParameters parameters;
  try {
    setParameter("odom_alpha1", "0.2", &parameters);
    ADD_FAILURE() << "no ParameterError was thrown";
  } catch (const ParameterError& error) {
    EXPECT_STREQ(error.what(),
                 "there is no parameter 'odom_alpha1'; that of amcl is "
                 "'expert/rotation_noise_from_rotation' here (docs/migrating.md)");
  }
  EXPECT_NE(foreignHint("update_min_d").find("every scan is used"), std::string::npos);
  EXPECT_EQ(foreignHint("num_particels"), "");
}

TEST(ForeignParameters, AmclsVariancesBecomeStandardDeviations) {
  const Texts ours = translateParameters("amcl", {{"odom_alpha1", "0.04"},
                                                  {"min_particles", "300"},
                                                  {"odom_frame_id", "/odom"},
                                                  {"odom_model_type", "diff-corrected"},
                                                  {"laser_z_hit", "0.9"},
                                                  {"laser_z_rand", "0.1"},
                                                  {"initial_pose_x", "2.5"}})
                         .parameters;
  const LocalizerParameters p = applied(ours);
  EXPECT_NEAR(p.motion.rotation_noise_from_rotation, 0.2, 1e-9);
  EXPECT_EQ(p.motion.motion_model, MotionNoise::kDifferential);
  EXPECT_EQ(p.filter.num_particles, 300);
  EXPECT_NEAR(p.sensor.field.z_rand, 0.1, 1e-9);
  EXPECT_EQ(ours.at("odom_frame"), "odom");
  EXPECT_EQ(ours.at("initial_pose"), "2.5 0 0");
  EXPECT_EQ(ours.at("motion_from"), "tf");
  EXPECT_EQ(ours.at("tf_mode"), "map_to_odom");
}

TEST(ForeignParameters, MitsBeamsAndSquashingBecomeEffectiveBeams) {
  const LocalizerParameters p = applied(translateParameters("mit_pf", {{"angle_step", "18"},
                                                                       {"squash_factor", "2.2"},
                                                                       {"range_method", "cddt"},
                                                                       {"z_short", "0.01"},
                                                                       {"max_particles", "2000"}})
                                            .parameters);
  EXPECT_EQ(p.scan.num_beams_per_particle, 60);
  EXPECT_NEAR(p.effective_beams, 60 / 2.2, 1e-6);
  EXPECT_EQ(p.filter.num_particles, 2000);
  EXPECT_EQ(p.sensor.sensor_model, SensorModelType::kBeam);
  EXPECT_NEAR(p.sensor.beam.table.alpha_hit, 0.75 / 0.95, 1e-9);
}

TEST(ForeignParameters, OwnNamesAreKeptAndWrongOnesAreRefused) {
  const ForeignTranslation lab = translateParameters(
      "lab5", {{"deterministic", "true"}, {"map_topic", "/map"}, {"num_threads", "2"}});
  EXPECT_EQ(lab.parameters, (Texts{{"expert/deterministic", "true"}, {"num_threads", "2"}}));
  ASSERT_EQ(lab.notes.size(), 1U);
  EXPECT_EQ(lab.notes[0], "map_topic: remap map");
  const Texts both = translateParameters("amcl", {{"min_particles", "300"},
                                                  {"num_particles", "400"},
                                                  {"motion_from", "pose"},
                                                  {"tf_mode", "off"}})
                         .parameters;
  EXPECT_EQ(both, (Texts{{"num_particles", "400"}, {"motion_from", "pose"}, {"tf_mode", "off"}}));
  EXPECT_THROW(translateParameters("gmapping", {}), ParameterError);
  EXPECT_THROW(translateParameters("amcl", {{"laser_model_type", "sonar"}}), ParameterError);
  EXPECT_THROW(translateParameters("amcl", {{"odom_alpha1", "much"}}), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl
