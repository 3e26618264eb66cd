// Parameters that change between two scans.
#include <gtest/gtest.h>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, KeepsPoseParticlesAndStatusIfParametersChange) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 2.0);
  const PoseEstimate before = *localizer.estimateAt(start_ + 2.0);
  const LocalizationState state = localizer.status().state;
  LocalizerParameters changed = fewBeams();
  changed.filter.num_particles = 345;
  changed.motion.yaw_noise_from_translation = 0.06;
  changed.scan.min_beams = 12;
  localizer.setParameters(changed, localizer.map());
  EXPECT_EQ(localizer.estimateAt(start_ + 2.0)->base_in_map.x, before.base_in_map.x);
  EXPECT_EQ(localizer.status().state, state);
  EXPECT_EQ(localizer.particles().size(), 200);
  drive(&localizer, 2.0, 2.1);
  EXPECT_EQ(localizer.particles().size(), 345);
  drive(&localizer, 2.1, 4.0);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, truthAt(start_ + 4.0), 0.1, 0.05);
  changed.filter.num_particles = 50;
  localizer.setParameters(changed, localizer.map());
  drive(&localizer, 4.0, 4.1);
  EXPECT_LT(localizer.particles().size(), 345) << "by KLD sampling, as far as the set is narrow";
}

TEST_F(LocalizerTest, TakesAnotherSensorModelWithAMapThatWasBuiltForIt) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  LocalizerParameters changed = fewBeams();
  changed.sensor.sensor_model = SensorModelType::kLikelihoodField;
  EXPECT_TRUE(needsNewMap(fewBeams(), changed));
  EXPECT_THROW(localizer.setParameters(changed, localizer.map()), std::invalid_argument);
  EXPECT_EQ(localizer.parameters().sensor.sensor_model, SensorModelType::kBeam);
  localizer.setParameters(changed, map(changed));
  drive(&localizer, 1.0, 3.0);
  expectNear(localizer.estimateAt(start_ + 3.0)->base_in_map, truthAt(start_ + 3.0), 0.1, 0.05);
}

TEST_F(LocalizerTest, AWrongParameterChangesNothing) {
  Localizer localizer = started();
  LocalizerParameters wrong = fewBeams();
  wrong.filter.num_particles = 100;
  wrong.monitor.lost_conflict = -1.0;
  EXPECT_THROW(localizer.setParameters(wrong, localizer.map()), ParameterError);
  EXPECT_EQ(localizer.parameters().filter.num_particles, 200);
}

TEST(NeedsNewMap, IfWhatTheMapIsBuiltFromDiffers) {
  const LocalizerParameters before;
  LocalizerParameters after = before;
  after.filter.num_particles = 300;
  after.motion.yaw_noise_from_rotation = 0.5;
  EXPECT_FALSE(needsNewMap(before, after));
  after.sensor.field.field_scale = 0.1;
  EXPECT_TRUE(needsNewMap(before, after));
  after = before;
  after.effective_beams = 20.0;
  EXPECT_TRUE(needsNewMap(before, after));
}

}  // namespace
}  // namespace racecar_mcl
