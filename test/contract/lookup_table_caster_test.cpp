// Contract of the lookup table caster beyond that of all casters.
#include "raycasting/lookup_table_caster.h"

#include <gtest/gtest.h>

#include <limits>

#include "caster_contract.h"
#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

RangeCasterParameters parametersWith(double memory) {
  RangeCasterParameters parameters;
  parameters.range_method = "lut";
  parameters.lut_memory = memory;
  return parameters;
}

std::vector<Pose2> cloud(const Pose2& centre, int count, double sigma, std::uint64_t seed) {
  Random random(seed);
  std::vector<Pose2> poses;
  for (int i = 0; i < count; ++i) {
    const double x = centre.x + sigma * random.gaussian();
    const double y = centre.y + sigma * random.gaussian();
    poses.push_back({x, y, centre.yaw + sigma * random.gaussian()});
  }
  return poses;
}

Eigen::ArrayXXf castAll(const RangeCaster& caster, const std::vector<Pose2>& list) {
  const Poses poses(list);
  Eigen::ArrayXXf ranges(60, poses.batch().size);
  caster.cast(poses.batch(), fan(60), ranges);
  return ranges;
}

/// A drive across the floor plan's room: the fractions of ranges with errors above one and above
/// three cells.
std::pair<double, double> driveWith(RangeCaster& caster, const OccupancyGrid& grid) {
  RangeCasterParameters exact;
  exact.range_method = "distance_transform";
  const auto reference = makeRangeCaster(grid, exact);
  double over_one = 0.0;
  double over_three = 0.0;
  double scans = 0.0;
  for (double column = 25.0; column < 120.0; column += 3.0, ++scans) {
    const Eigen::Vector2d point = gridToWorld(grid.geometry(), {column, 75.0 + column / 8.0});
    const std::vector<Pose2> list =
        cloud({point.x(), point.y(), 0.3}, 600, 0.05, static_cast<std::uint64_t>(column * 2));
    const Poses poses(list);
    caster.prepare(poses.batch(), fan(60));
    const Eigen::ArrayXXf off = (castAll(caster, list) - castAll(*reference, list)).abs() / 0.05F;
    over_one += static_cast<double>((off > 1.0F).cast<float>().mean());
    over_three += static_cast<double>((off > 3.0F).cast<float>().mean());
  }
  return {over_one / scans, over_three / scans};
}

TEST(LookupTableCaster, StaysWithinItsErrorOverADrive) {
  const OccupancyGrid grid = floorPlan();
  LookupTableCaster caster(grid, parametersWith(60.0));
  const auto [over_one, over_three] = driveWith(caster, grid);
  EXPECT_GT(over_one, 0.001);  // ranges are from the table
  EXPECT_LT(over_one, 0.05);
  EXPECT_LT(over_three, 0.02);
}

TEST(LookupTableCaster, ReplacesTheOldestRowsIfMemoryIsShort) {
  const OccupancyGrid grid = floorPlan();
  LookupTableCaster caster(grid, parametersWith(0.3));  // 140 rows
  const auto [over_one, over_three] = driveWith(caster, grid);
  EXPECT_GT(over_one, 0.001);
  EXPECT_LT(over_one, 0.05);
  EXPECT_LT(over_three, 0.02);
}

TEST(LookupTableCaster, StaysWithinItsMemory) {
  const OccupancyGrid grid = floorPlan();
  const std::size_t field = SimdCaster(grid, parametersWith(0.0)).memoryBytes();
  EXPECT_LE(LookupTableCaster(grid, parametersWith(60.0)).memoryBytes(),
            60'000'000 + field + 10'000);
  EXPECT_LE(LookupTableCaster(grid, parametersWith(0.0)).memoryBytes(), field + 100'000);
}

TEST(LookupTableCaster, IsExactWithoutRows) {
  const OccupancyGrid grid = floorPlan();
  const SimdCaster exact(grid, parametersWith(0.0));
  const Eigen::Vector2d point = gridToWorld(grid.geometry(), {70.0, 80.0});
  const std::vector<Pose2> list = cloud({point.x(), point.y(), 1.0}, 300, 0.05, 1);
  const Eigen::ArrayXXf expected = castAll(exact, list);

  const LookupTableCaster unprepared(grid, parametersWith(60.0));
  EXPECT_TRUE((castAll(unprepared, list) == expected).all());

  LookupTableCaster without_memory(grid, parametersWith(0.0));
  const Poses poses(list);
  for (int i = 0; i < 5; ++i) without_memory.prepare(poses.batch(), fan(60));
  EXPECT_TRUE((castAll(without_memory, list) == expected).all());
}

TEST(LookupTableCaster, FillsNoRowForAFewRays) {
  const OccupancyGrid grid = floorPlan();
  const SimdCaster exact(grid, parametersWith(0.0));
  LookupTableCaster caster(grid, parametersWith(60.0));
  const std::vector<Pose2> list = cloud({5.0, 3.0, 1.0}, 20, 1.0, 2);
  const Poses poses(list);
  caster.prepare(poses.batch(), fan(60));
  EXPECT_TRUE((castAll(caster, list) == castAll(exact, list)).all());
}

TEST(LookupTableCaster, RejectsParametersOutOfRange) {
  const OccupancyGrid grid = floorPlan();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -0.1, nan}) {
    RangeCasterParameters parameters = parametersWith(60.0);
    parameters.lut_spacing = bad;
    EXPECT_THROW(makeRangeCaster(grid, parameters), ParameterError) << bad;
  }
  for (const int bad : {-5, 0, 15, 16385}) {
    RangeCasterParameters parameters = parametersWith(60.0);
    parameters.lut_directions = bad;
    EXPECT_THROW(makeRangeCaster(grid, parameters), ParameterError) << bad;
  }
  for (const double bad : {-1.0, 1e9, nan}) {
    EXPECT_THROW(makeRangeCaster(grid, parametersWith(bad)), ParameterError) << bad;
  }
}

/// Whether two poses have the same ranges from the table.
bool haveOneRow(const RangeCasterParameters& parameters, const Pose2& one, const Pose2& other) {
  LookupTableCaster caster(floorPlan(), parameters, LookupTableCaster::BuildPolicy::kAtOnce);
  const std::vector<Pose2> list{one, other};
  const Poses poses(list);
  caster.prepare(poses.batch(), fan(60));
  const Eigen::ArrayXXf ranges = castAll(caster, list);
  return (ranges.col(0) == ranges.col(1)).all();
}

TEST(LookupTableCaster, HasTheResolutionOfItsParameters) {
  const GridGeometry geometry = floorPlan().geometry();
  const Eigen::Vector2d lower = gridToWorld(geometry, {70.2, 80.2});
  const Eigen::Vector2d upper = gridToWorld(geometry, {70.8, 80.8});
  RangeCasterParameters parameters = parametersWith(60.0);
  EXPECT_FALSE(haveOneRow(parameters, {lower.x(), lower.y(), 0.0}, {upper.x(), upper.y(), 0.0}));
  EXPECT_FALSE(haveOneRow(parameters, {lower.x(), lower.y(), 0.02}, {lower.x(), lower.y(), 0.05}));
  parameters.lut_spacing = geometry.resolution;
  EXPECT_TRUE(haveOneRow(parameters, {lower.x(), lower.y(), 0.0}, {upper.x(), upper.y(), 0.0}));
  parameters.lut_directions = 16;
  const double yaw = geometry.origin.yaw;
  EXPECT_TRUE(
      haveOneRow(parameters, {lower.x(), lower.y(), yaw}, {lower.x(), lower.y(), yaw + 1e-3}));
}

}  // namespace
}  // namespace racecar_mcl
