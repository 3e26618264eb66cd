#include "racecar_mcl/localizer/localization_map.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "racecar_mcl/common/errors.h"
#include "support/particle_filter_fixture.h"

namespace racecar_mcl {
namespace {

TEST(LocalizationMap, HasNoLikelihoodFieldForAnotherSensorModel) {
  const auto map = makeLocalizationMap(asciiMap(kRoom, 0.1), sensor(beamModel()));
  EXPECT_NO_THROW(makeSensorModel(*map, sensor(beamModel())));
  EXPECT_THROW(makeSensorModel(*map, SensorParameters{}), std::invalid_argument);
}

TEST(LocalizationMap, TheSensorModelCastsByTheRangeMethod) {
  SensorParameters parameters = sensor(beamModel());
  const auto map = makeLocalizationMap(asciiMap(kRoom, 0.1), parameters);
  parameters.caster.range_method = "sonar";
  EXPECT_THROW(makeSensorModel(*map, parameters), ParameterError);
}

TEST(LocalizationMap, RejectsAMapWithoutFreeCells) {
  for (const char* drawing : {"###", "???", "#?#"}) {
    EXPECT_THROW(makeLocalizationMap(asciiMap(drawing, 0.1), sensor(beamModel())), MapError);
  }
}

TEST(LocalizationMap, RejectsAMapWithoutOccupiedCells) {
  for (const char* drawing : {"...", "?.?", "."}) {
    EXPECT_THROW(makeLocalizationMap(asciiMap(drawing, 0.1), sensor(beamModel())), MapError);
  }
}

TEST(LocalizationMap, ExpectedRangesReachTheRangeOfTheBeamTable) {
  // The table of 101 pixels reaches to 10 m.
  const auto with = [](double max_range) {
    return makeLocalizationMap(asciiMap(kRoom, 0.1), sensor(beamModel(), max_range));
  };
  EXPECT_NEAR(with(0.0)->caster->maxRange(), 10.0, 1e-9);
  EXPECT_EQ(with(10.0)->caster->maxRange(), 10.0);
  EXPECT_EQ(with(30.0)->caster->maxRange(), 30.0);
  EXPECT_THROW(with(5.0), ParameterError);
  EXPECT_THROW(with(-1.0), ParameterError);
  EXPECT_THROW(with(std::numeric_limits<double>::quiet_NaN()), ParameterError);
}

TEST(LocalizationMap, RangesReachTheMaximumRangeOfTheLikelihoodField) {
  const auto maxRangeWith = [](double max_range) {
    SensorParameters parameters = sensor(beamModel(), max_range);
    parameters.sensor_model = SensorModelType::kLikelihoodField;
    parameters.field.field_max_range = 17.0;
    return makeLocalizationMap(asciiMap(kRoom, 0.1), parameters)->caster->maxRange();
  };
  EXPECT_EQ(maxRangeWith(0.0), 17.0);
  EXPECT_EQ(maxRangeWith(5.0), 5.0) << "the beam table is not used";
  EXPECT_EQ(maxRangeWith(30.0), 30.0);
  EXPECT_THROW(maxRangeWith(-1.0), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl
