// A car that is told nothing, driving on the simulated maps.
#include <gtest/gtest.h>

#include "evaluation/simulated_drive.h"

namespace racecar_mcl {
namespace {

class GlobalStartTest : public ::testing::TestWithParam<const char*> {
 protected:
  /// The largest error in the last second of `seconds` of driving from a random pose.
  double errorAfter(double seconds, std::uint64_t seed) const {
    Random random(seed);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive drive(course_, parameters_, {}, pose, 3.0, seed);
    EXPECT_TRUE(drive.localizer().initializeGlobally());
    drive.drive(seconds - 1.0, [](const Observation&) {});
    double largest = 0.0;
    drive.drive(1.0, [&](const Observation& seen) { largest = std::max(largest, seen.error); });
    return largest;
  }

  LocalizerParameters parameters_;
  Course course_ =
      loadCourse(std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml", parameters_);
};

TEST_P(GlobalStartTest, FindsItselfFromRandomPoses) {
  for (const std::uint64_t seed : {1, 2, 3}) EXPECT_LT(errorAfter(3.0, seed), 0.2) << seed;
}

TEST_P(GlobalStartTest, GivesTheSameForTheSameSeed) {
  EXPECT_EQ(errorAfter(1.2, 7), errorAfter(1.2, 7));
}

INSTANTIATE_TEST_SUITE_P(Maps, GlobalStartTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
