// Contract of the range casters on whole maps: agreement with the definition, with the exact
// reference, and between calls.
#include <gtest/gtest.h>

#include <thread>

#include "caster_contract.h"
#include "caster_reference.h"
#include "racecar_mcl/map/cell_runs.h"

namespace racecar_mcl {
namespace {

class CasterAgreement : public RangeCasterContract {
 protected:
  /// A caster and its ranges from all poses of a world.
  struct WholeBatch {
    std::unique_ptr<RangeCaster> caster;
    Eigen::ArrayXf bearings;
    Poses poses;
    Eigen::ArrayXXf ranges;
  };

  WholeBatch castWhole(std::uint64_t seed, int beams, int count) const {
    RandomWorld world(seed, 150, 100);
    const std::vector<Pose2> poses = world.poses(count, 2.0);
    WholeBatch whole{makeCaster(*world.grid, 4.0), fan(beams), Poses(poses), {}};
    whole.ranges = castAll(*whole.caster, poses, whole.bearings);
    return whole;
  }
};

TEST_P(CasterAgreement, AgreesWithTheDefinitionOnRandomMaps) {
  const double max_range = 4.0;
  const Eigen::ArrayXf bearings = fan(40);
  for (const UnknownIs unknown_is : {UnknownIs::kFree, UnknownIs::kOccupied}) {
    std::vector<double> errors;
    for (const auto& [width, height] : {std::pair(120, 35), std::pair(40, 90)}) {
      RandomWorld world(7, width, height);
      const auto caster = makeCaster(*world.grid, max_range, unknown_is);
      const std::vector<Pose2> poses = world.poses(60, 3.0);
      const Eigen::ArrayXXf ranges = castAll(*caster, poses, bearings);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        for (Eigen::Index k = 0; k < bearings.size(); ++k) {
          const double expected = bruteForceRange(
              *world.grid, unknown_is, max_range,
              {poses[i].x, poses[i].y, poses[i].yaw + static_cast<double>(bearings[k])});
          const double got = static_cast<double>(ranges(k, static_cast<Eigen::Index>(i)));
          errors.push_back(std::abs(got - expected) / world.grid->geometry().resolution);
        }
      }
    }
    const Promise promise = promiseOf(GetParam().name);
    EXPECT_LE(quantile(errors, 0.95), promise.scattered_p95);
    EXPECT_LE(quantile(errors, 0.999), promise.p999);
  }
}

TEST_P(CasterAgreement, AgreesWithTheReferenceInAFloorPlan) {
  const OccupancyGrid grid = floorPlan();
  RangeCasterParameters exact;
  exact.range_method = "bresenham";
  const auto reference = makeRangeCaster(grid, exact);
  const auto caster = makeCaster(grid, exact.max_range);
  const Eigen::ArrayXf bearings = fan(100);
  const CellRuns free_cells = freeCells(grid);
  Random random(11);
  std::vector<Pose2> poses;
  for (int i = 0; i < 400; ++i) {
    const Cell cell = free_cells[random.index(free_cells.size())];
    const Eigen::Vector2d point =
        gridToWorld(grid.geometry(), {cell.column + random.uniform(), cell.row + random.uniform()});
    poses.push_back({point.x(), point.y(), random.uniform(-kPi, kPi)});
  }
  const Eigen::ArrayXXf got = castAll(*caster, poses, bearings);
  const Eigen::ArrayXXf expected = castAll(*reference, poses, bearings);
  const Eigen::ArrayXXd off = (got - expected).abs().cast<double>() / grid.geometry().resolution;
  const std::vector<double> errors(off.data(), off.data() + off.size());
  const Promise promise = promiseOf(GetParam().name);
  EXPECT_LE(quantile(errors, 0.95), promise.p95);
  EXPECT_LE(quantile(errors, 0.999), promise.p999);
  EXPECT_LE((off > 3.0).cast<double>().mean(), promise.over_three);
}

TEST_P(CasterAgreement, CastsAChunkLikeTheWhole) {
  const WholeBatch whole = castWhole(8, 37, 101);
  Eigen::ArrayXXf chunks(whole.ranges.rows(), whole.ranges.cols());
  for (Eigen::Index first = 0; first < 101; first += 7) {
    const Eigen::Index count = std::min<Eigen::Index>(7, 101 - first);
    whole.caster->cast(whole.poses.batch().segment(first, count), whole.bearings,
                       chunks.middleCols(first, count));
  }
  EXPECT_TRUE((chunks == whole.ranges).all());
}

TEST_P(CasterAgreement, CastsFromSeveralThreadsAtOnce) {
  const WholeBatch whole = castWhole(9, 50, 200);
  std::vector<Eigen::ArrayXXf> results(4,
                                       Eigen::ArrayXXf(whole.ranges.rows(), whole.ranges.cols()));
  std::vector<std::thread> threads;
  for (Eigen::ArrayXXf& result : results) {
    threads.emplace_back([&, constant = static_cast<const RangeCaster*>(whole.caster.get())] {
      constant->cast(whole.poses.batch(), whole.bearings, result);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Eigen::ArrayXXf& result : results) EXPECT_TRUE((result == whole.ranges).all());
}

TEST(SimdCaster, IsBitIdenticalForEveryInstructionSet) {
  RandomWorld world(10, 300, 200);
  RangeCasterParameters parameters;
  parameters.max_range = 8.0;
  const Eigen::ArrayXf bearings = fan(301);  // more than a block
  const Poses poses(world.poses(50, 4.0));
  Eigen::ArrayXXf expected;
  for (const InstructionSet set : availableInstructionSets()) {
    Eigen::ArrayXXf ranges(bearings.size(), poses.batch().size);
    SimdCaster(*world.grid, parameters, set).cast(poses.batch(), bearings, ranges);
    if (expected.size() == 0) expected = ranges;
    EXPECT_TRUE((ranges == expected).all()) << nameOf(set);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryCaster, CasterAgreement, testing::ValuesIn(subjects()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace racecar_mcl
