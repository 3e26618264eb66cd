#include "racecar_mcl/monitoring/localizability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "racecar_mcl/localizer/localization_map.h"

namespace racecar_mcl {
namespace {

/// A corridor along the map's x axis, 30 m long and 2 m wide; with pillars every 2 m if asked for.
std::shared_ptr<const LocalizationMap> corridor(bool pillars) {
  GridGeometry geometry;
  geometry.resolution = 0.05;
  geometry.width = 600;
  geometry.height = 44;
  std::vector<std::int8_t> cells(600 * 44, 0);
  for (std::size_t column = 0; column < 600; ++column) {
    for (const std::size_t row : {0u, 1u, 42u, 43u}) cells[row * 600 + column] = 100;
    if (!pillars || column % 40 > 3) continue;
    for (std::size_t row = 2; row < 6; ++row) cells[row * 600 + column] = 100;
  }
  return makeLocalizationMap(OccupancyGrid(geometry, cells), SensorParameters());
}

Localizability expectedIn(const LocalizationMap& map, double yaw) {
  const Eigen::ArrayXf bearings = Eigen::ArrayXf::LinSpaced(240, -2.35f, 2.35f);
  return localizabilityOf(
      expectedInformation(map.view(), *map.likelihood_field, {15.0, 1.1, yaw}, bearings), yaw);
}

TEST(Localizability, ABlankCorridorDeterminesThePositionAcrossAlone) {
  const auto map = corridor(false);
  const Localizability found = expectedIn(*map, 0.0);
  EXPECT_LT(found.across, 0.03);
  EXPECT_GT(found.along, 10.0 * found.across);
  EXPECT_LT(found.heading, 0.03);
  // The car looks across.
  const Localizability turned = expectedIn(*map, kPi / 2.0);
  EXPECT_GT(turned.across, 10.0 * turned.along);
}

TEST(Localizability, PillarsDetermineThePositionAlong) {
  const Localizability blank = expectedIn(*corridor(false), 0.0);
  const Localizability pillars = expectedIn(*corridor(true), 0.0);
  EXPECT_LT(pillars.along, 0.2 * blank.along);
  EXPECT_LT(pillars.along, 0.1);
}

TEST(Localizability, IsUnlimitedWithoutBeams) {
  const auto map = corridor(true);
  Scan beams;
  beams.bearings = beams.ranges = beams.seconds_after_stamp = Eigen::ArrayXf::Zero(0);
  const Localizability none = localizabilityOf(
      poseInformation(scanScore(*map->likelihood_field, {15.0, 1.1, 0.0}, beams)), 0.3);
  EXPECT_NEAR(none.along, 10.0, 1e-9);
  EXPECT_NEAR(none.across, 10.0, 1e-9);
  EXPECT_NEAR(none.heading, 10.0, 1e-9);
}

TEST(Localizability, MoreBeamsWithTheSameExponentDetermineMore) {
  const auto map = corridor(true);
  const auto along = [&](int count) {
    const Eigen::ArrayXf bearings = Eigen::ArrayXf::LinSpaced(count, -2.35f, 2.35f);
    return localizabilityOf(
               expectedInformation(map->view(), *map->likelihood_field, {15.0, 1.1, 0.0}, bearings),
               0.0)
        .along;
  };
  EXPECT_NEAR(along(480), along(240) / std::sqrt(2.0), 0.1 * along(240));
}

}  // namespace
}  // namespace racecar_mcl
