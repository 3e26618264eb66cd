#include "racecar_mcl/scan_fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/wall_ahead.h"

namespace racecar_mcl {
namespace {

class ScanFitTest : public WallAhead {
 protected:
  ScanFit fit(float range) { return fitScan(map_.get(), car_, beamsAhead(10, range)); }
};

TEST_F(ScanFitTest, ExplainsBeamsThatEndAtTheWall) {
  const ScanFit at_wall = fit(3.05f);
  EXPECT_EQ(at_wall.beams, 10);
  EXPECT_EQ(at_wall.explained, 1.0);
}

TEST_F(ScanFitTest, DoesNotExplainWhatTheMapDoesNotShow) { EXPECT_EQ(fit(1.5f).explained, 0.0); }

TEST_F(ScanFitTest, DoesNotExplainBeamsThatPassAWall) {
  EXPECT_EQ(fit(11.0f).explained, 0.0);  // at the wall behind the wall
}

TEST_F(ScanFitTest, DoesNotJudgeBeamsThatProveNothing) {
  EXPECT_EQ(fit(std::numeric_limits<float>::infinity()).beams, 0);
  EXPECT_EQ(fit(0.05f).beams, 0) << "a covered lidar";
}

}  // namespace
}  // namespace racecar_mcl
