// Weights that vanish: the node must count them, keep publishing finite poses (checked by the
// listener) and continue with the next scan.
#include <cstdlib>

#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

class LocalizationFailureTest : public LocalizationTest {
 protected:
  int diagnostic(const std::string& key) { return std::atoi(listener_.diagnostic(key).c_str()); }
};

TEST_F(LocalizationFailureTest, VanishedWeightsLeaveFinitePosesAndAreCounted) {
  parameters_.setParam("sensor_model", "beam");
  // No range at or beyond the expected one is possible, so no particle explains a scan.
  parameters_.setParam("alpha_hit", 0.0);
  parameters_.setParam("alpha_short", 0.9);
  parameters_.setParam("alpha_max", 0.1);
  parameters_.setParam("alpha_rand", 0.0);
  startLocalized();
  const int answered = drive(2.0);
  EXPECT_EQ(answered, 50) << "every scan is answered by a pose";
  EXPECT_TRUE(listener_.waitFor(
      [&] { return diagnostic("scans with vanished weights") + diagnostic("scans used") >= 50; }));
  EXPECT_GE(diagnostic("scans with vanished weights"), 45);
  EXPECT_EQ(diagnostic("internal errors"), 0);
  expectLocalized(0.5);  // by odometry alone
}

}  // namespace
}  // namespace racecar_mcl
