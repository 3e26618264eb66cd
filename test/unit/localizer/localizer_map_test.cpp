#include <gtest/gtest.h>

#include <algorithm>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

TEST_F(LocalizerTest, ANewMapKeepsThePose) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  const PoseEstimate before = *localizer.estimateAt(start_ + 1.0);
  const ParticleSet particles = localizer.particles();
  localizer.setMap(map());
  expectSame(*localizer.estimateAt(start_ + 1.0), before);
  EXPECT_TRUE((localizer.particles().x == particles.x).all());
  double worst = 0.0;
  drive(&localizer, 1.0, 2.0, [&](const ScanResult& result) {
    EXPECT_EQ(result.outcome, ScanOutcome::kUsed);
    worst = std::max(worst, distance(result.update.estimate.base_in_map, truthAt(result.stamp)));
  });
  EXPECT_LT(worst, 0.08);
}

TEST_F(LocalizerTest, UsesTheNewMapFromThenOn) {
  Localizer localizer = started();
  drive(&localizer, 0.0, 1.0);
  // The same room, 6 cm farther along x: the pose follows the map.
  GridGeometry shifted = room_.grid().geometry();
  shifted.origin.x += 0.06;
  localizer.setMap(makeLocalizationMap(OccupancyGrid(shifted, room_.grid().cells()), fewBeams()));
  drive(&localizer, 1.0, 4.0);
  const Pose2 truth = truthAt(start_ + 4.0);
  expectNear(localizer.estimateAt(start_ + 4.0)->base_in_map, {truth.x + 0.06, truth.y, truth.yaw},
             0.04, 0.03);
}

}  // namespace
}  // namespace racecar_mcl
