#include <gtest/gtest.h>

#include "racecar_mcl/localizer/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

class LocalizerDistanceFilterTest : public LocalizerTest {
 protected:
  /// A scan in the room with an unmapped obstacle in front of the middle beams.
  Scan blocked(double stamp, int beams) const {
    Scan scan = scanAt(stamp);
    scan.ranges.segment(scan.size() / 2 - beams / 2, beams) =
        scan.ranges.segment(scan.size() / 2 - beams / 2, beams).min(0.7f);
    return scan;
  }

  /// The result of that scan after a drive of 1 s without obstacles.
  ScanResult meet(int beams, bool reject, int min_beams = 10) const {
    LocalizerParameters parameters = fewBeams();
    parameters.scan.beam_layout = BeamLayout::kEven;
    parameters.distance_filter = reject;
    parameters.scan.min_beams = min_beams;
    Localizer localizer = started(parameters);
    drive(&localizer, 0.0, 1.0,
          [&](const ScanResult& result) { EXPECT_EQ(result.update.beams, 40) << "no obstacle"; });
    EXPECT_EQ(localizer.status().state, LocalizationState::kLocalized);
    localizer.addOdometry(odometryAt(start_ + 1.02));
    return localizer.update(blocked(start_ + 1.02, beams));
  }
};

TEST_F(LocalizerDistanceFilterTest, AreRejectedWhileLocalizedButStillMonitored) {
  const ScanResult rejected = meet(27, true);  // every 4.5th beam is selected
  EXPECT_EQ(rejected.update.beams, 34);
  const ScanResult weighed = meet(27, false);
  EXPECT_EQ(weighed.update.beams, 40);
  EXPECT_LT(rejected.status.inlier_ratio, 0.999);
  EXPECT_NEAR(rejected.status.inlier_ratio, weighed.status.inlier_ratio, 1e-3);
}

TEST_F(LocalizerDistanceFilterTest, AreAllUsedIfMostBeamsAreShort) {
  EXPECT_EQ(meet(120, true).update.beams, 40);
}

TEST_F(LocalizerDistanceFilterTest, AreAllUsedIfFewerThanTheLeastNumberRemain) {
  EXPECT_EQ(meet(27, true, 34).update.beams, 34);
  EXPECT_EQ(meet(27, true, 35).update.beams, 40);
}

TEST_F(LocalizerDistanceFilterTest, AreUsedUntilLocalized) {
  LocalizerParameters parameters = fewBeams();
  parameters.distance_filter = true;
  Localizer localizer = started(parameters);
  ASSERT_EQ(localizer.status().state, LocalizationState::kInitializing);
  EXPECT_EQ(localizer.update(blocked(start_, 27)).update.beams, 40);
}

}  // namespace
}  // namespace racecar_mcl
