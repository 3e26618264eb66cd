#include <gtest/gtest.h>

#include "racecar_mcl/localizer.h"
#include "support/localizer_fixture.h"

namespace racecar_mcl {
namespace {

class ShortReturnsTest : public LocalizerTest {
 protected:
  /// As the room shows it, but with something unmapped in the way of the middle beams.
  Scan blocked(double stamp, int beams) const {
    Scan scan = scanAt(stamp);
    scan.ranges.segment(scan.size() / 2 - beams / 2, beams) =
        scan.ranges.segment(scan.size() / 2 - beams / 2, beams).min(0.7f);
    return scan;
  }

  /// Beams weighed of the scan after a drive of 1 s in which nothing was in the way.
  ScanResult meet(int beams, bool reject) const {
    LocalizerParameters parameters = fewBeams();
    parameters.beam_layout = BeamLayout::kEven;
    parameters.reject_short_returns = reject;
    Localizer localizer = started(parameters);
    drive(&localizer, 0.0, 1.0, [&](const ScanResult& result) {
      EXPECT_EQ(result.update.beams, 40) << "nothing is in the way";
    });
    EXPECT_EQ(localizer.verdict().state, VerdictState::kLocalized);
    localizer.addOdometry(odometryAt(start_ + 1.02));
    return localizer.addScan(blocked(start_ + 1.02, beams));
  }
};

TEST_F(ShortReturnsTest, AreNotWeighedWhileLocalizedButStillJudged) {
  const ScanResult rejected = meet(27, true);  // every 4.5th beam is chosen
  EXPECT_EQ(rejected.update.beams, 34);
  const ScanResult weighed = meet(27, false);
  EXPECT_EQ(weighed.update.beams, 40);
  EXPECT_LT(rejected.verdict.explained, 0.999);
  EXPECT_NEAR(rejected.verdict.explained, weighed.verdict.explained, 1e-3);
}

TEST_F(ShortReturnsTest, AreAllWeighedWhereMostBeamsAreShort) {
  EXPECT_EQ(meet(120, true).update.beams, 40);
}

TEST_F(ShortReturnsTest, AreWeighedUntilLocalized) {
  LocalizerParameters parameters = fewBeams();
  parameters.reject_short_returns = true;
  Localizer localizer = started(parameters);
  ASSERT_EQ(localizer.verdict().state, VerdictState::kConverging);
  EXPECT_EQ(localizer.addScan(blocked(start_, 27)).update.beams, 40);
}

}  // namespace
}  // namespace racecar_mcl
