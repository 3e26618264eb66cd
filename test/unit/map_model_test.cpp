#include "racecar_mcl/map_model.h"

#include <gtest/gtest.h>

#include <limits>

#include "racecar_mcl/errors.h"
#include "support/filter_room.h"

namespace racecar_mcl {
namespace {

TEST(MapModel, RefusesAMapWithoutAFreeCell) {
  for (const char* drawing : {"###", "???", "#?#"}) {
    EXPECT_THROW(makeMapModel(asciiMap(drawing, 0.1), sensor(beamModel())), MapError);
  }
}

TEST(MapModel, ExpectedRangesReachAsFarAsMeasuredOnes) {
  // The table of 101 pixels reaches to 10 m.
  const auto with = [](double max_range) {
    return makeMapModel(asciiMap(kRoom, 0.1), sensor(beamModel(), max_range));
  };
  EXPECT_NO_THROW(with(0.0));
  EXPECT_NO_THROW(with(10.0));
  EXPECT_NO_THROW(with(30.0));
  EXPECT_THROW(with(5.0), ParameterError);
  EXPECT_THROW(with(-1.0), ParameterError);
  EXPECT_THROW(with(std::numeric_limits<double>::quiet_NaN()), ParameterError);
}

TEST(MapModel, RangesOfALikelihoodFieldReachAsFarAsItWeighsBeams) {
  const auto maxRangeWith = [](double max_range) {
    SensorParameters parameters = sensor(beamModel(), max_range);
    parameters.sensor_model = SensorModel::kLikelihoodField;
    parameters.field.field_max_range = 17.0;
    return makeMapModel(asciiMap(kRoom, 0.1), parameters)->max_range;
  };
  EXPECT_EQ(maxRangeWith(0.0), 17.0f);
  EXPECT_EQ(maxRangeWith(5.0), 5.0f) << "the beam table does not matter";
  EXPECT_EQ(maxRangeWith(30.0), 30.0f);
  EXPECT_THROW(maxRangeWith(-1.0), ParameterError);
}

}  // namespace
}  // namespace racecar_mcl
