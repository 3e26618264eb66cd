// Contract of the range casters on maps of any shape, from any pose, with any number of rays: valid
// ranges. With AddressSanitizer this also shows that no ray reads outside the map.
#include <gtest/gtest.h>

#include <cmath>

#include "caster_contract.h"

namespace racecar_mcl {
namespace {

/// A map of random shape and density, with poses and bearings.
struct OddWorld {
  explicit OddWorld(std::uint64_t seed) : random(seed) {
    const int sizes[] = {1, 1, 2, 3, 5, 17, 64, 129, 301};
    const auto size = [&] { return sizes[random.index(std::size(sizes))]; };
    const double density[] = {0.0, 0.0, 0.003, 0.02, 0.3, 1.0};
    const double share = density[random.index(std::size(density))];
    const GridGeometry geometry{
        size(),
        size(),
        random.uniform(0.01, 1.0),
        {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-4.0, 4.0)}};
    std::vector<std::int8_t> cells(static_cast<std::size_t>(geometry.width * geometry.height));
    for (std::int8_t& cell : cells) {
      const double chance = random.uniform();
      cell = chance < share         ? OccupancyGrid::kOccupied
             : chance < 1.2 * share ? OccupancyGrid::kUnknown
                                    : OccupancyGrid::kFree;
    }
    grid = std::make_unique<OccupancyGrid>(geometry, std::move(cells));
    unknown_is = random.uniform() < 0.5 ? UnknownIs::kFree : UnknownIs::kOccupied;
    max_range = std::pow(10.0, random.uniform(-1.0, 3.0)) * geometry.resolution;
    const int beams[] = {1, 2, 7, 31, 100, 257};
    bearings = Eigen::ArrayXf::LinSpaced(beams[random.index(std::size(beams))], -2.356F, 3.1F);
  }

  /// Inside and around the map.
  std::vector<Pose2> scattered() {
    return list([&](int size) { return random.uniform(-3.0, size + 3.0); },
                [&] { return random.uniform(-4.0, 4.0); });
  }

  /// On corners of cells and along the grid, so that rays run on borders.
  std::vector<Pose2> onCorners() {
    return list(
        [&](int size) {
          return static_cast<double>(random.index(static_cast<std::size_t>(size) + 1));
        },
        [&] {
          return grid->geometry().origin.yaw + kPi / 4.0 * static_cast<double>(random.index(8));
        });
  }

  Random random;
  std::unique_ptr<OccupancyGrid> grid;
  UnknownIs unknown_is = UnknownIs::kFree;
  double max_range = 1.0;
  Eigen::ArrayXf bearings;

 private:
  template <typename Coordinate, typename Yaw>
  std::vector<Pose2> list(Coordinate&& coordinate, Yaw&& yaw) {
    const GridGeometry& geometry = grid->geometry();
    std::vector<Pose2> poses(1 + random.index(40));
    for (Pose2& pose : poses) {
      const double column = coordinate(geometry.width);
      const Eigen::Vector2d point = gridToWorld(geometry, {column, coordinate(geometry.height)});
      pose = {point.x(), point.y(), yaw()};
    }
    return poses;
  }
};

constexpr std::uint64_t kWorlds = 60;

class CasterOnOddMaps : public RangeCasterContract {};

TEST_P(CasterOnOddMaps, CastsRangesBetweenZeroAndTheMaximum) {
  for (std::uint64_t seed = 0; seed < kWorlds; ++seed) {
    SCOPED_TRACE(seed);
    OddWorld world(seed);
    const auto caster = makeCaster(*world.grid, world.max_range, world.unknown_is);
    for (const std::vector<Pose2>& poses : {world.scattered(), world.onCorners()}) {
      const Eigen::ArrayXXf ranges = castAll(*caster, poses, world.bearings);
      ASSERT_TRUE((ranges >= 0.0F && ranges <= static_cast<float>(world.max_range)).all());
    }
  }
}

TEST_P(CasterOnOddMaps, CastsARayIndependentlyOfOthers) {
  for (std::uint64_t seed = 0; seed < kWorlds; ++seed) {
    SCOPED_TRACE(seed);
    OddWorld world(seed);
    const auto caster = makeCaster(*world.grid, world.max_range, world.unknown_is);
    std::vector<Pose2> poses = world.scattered();
    const Eigen::ArrayXXf ranges = castAll(*caster, poses, world.bearings);
    std::reverse(poses.begin(), poses.end());
    const Poses reversed(poses);
    Eigen::ArrayXXf again(ranges.rows(), ranges.cols());
    caster->cast(reversed.batch(), world.bearings, again);
    ASSERT_TRUE((again.rowwise().reverse() == ranges).all());
  }
}

TEST_P(CasterOnOddMaps, AgreesWithTheReference) {
  const Promise promise = promiseOf(GetParam().name);
  std::vector<double> errors;
  for (std::uint64_t seed = 0; seed < kWorlds; ++seed) {
    OddWorld world(seed);
    RangeCasterParameters exact;
    exact.range_method = "bresenham";
    exact.max_range = world.max_range;
    exact.unknown_is = world.unknown_is;
    const auto reference = makeRangeCaster(*world.grid, exact);
    const auto caster = makeCaster(*world.grid, world.max_range, world.unknown_is);
    const std::vector<Pose2> poses = world.scattered();
    const Eigen::ArrayXXf got = castAll(*caster, poses, world.bearings);
    const Eigen::ArrayXXf off = (got - castAll(*reference, poses, world.bearings)).abs() /
                                static_cast<float>(world.grid->geometry().resolution);
    errors.insert(errors.end(), off.data(), off.data() + off.size());
  }
  EXPECT_LE(quantile(errors, 0.95), promise.scattered_p95);
  EXPECT_LE(quantile(errors, 0.999), promise.p999);
}

INSTANTIATE_TEST_SUITE_P(EveryCaster, CasterOnOddMaps, testing::ValuesIn(subjects()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace racecar_mcl
