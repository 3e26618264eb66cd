// Global localization on the simulated maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "offline/simulated_drive.h"
#include "support/analytic_room.h"

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

  /// A stationary car with matching odometry.
  SimulatedDrive standingDrive(std::uint64_t seed) const {
    sim::SimulatorParameters simulator;
    simulator.odometry.noise = {};
    Random random(seed);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    return SimulatedDrive(course_, parameters_, simulator, pose, 1e-9, seed);
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

/// The first status `localized`.
struct FirstLocalized {
  double error = 0.0;  ///< m
  std::string reason_before;
};

TEST_P(GlobalStartTest, IsLocalizedOnceASecondSearchAgrees) {
  const auto firstLocalized = [this](Relocalization relocalization) {
    parameters_.relocalization = relocalization;
    Random random(3);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive drive(course_, parameters_, {}, pose, 3.0, 3);
    EXPECT_TRUE(drive.localizer().initializeGlobally());
    std::optional<FirstLocalized> first;
    std::string reason;
    drive.drive(4.0, [&](const Observation& seen) {
      const LocalizationStatus& status = seen.result.status;
      if (status.state == LocalizationState::kLocalized && !first) {
        first = FirstLocalized{seen.error, reason};
      }
      reason = status.reason;
    });
    EXPECT_TRUE(first.has_value());
    return first.value_or(FirstLocalized{});
  };
  const FirstLocalized unconfirmed = firstLocalized(Relocalization::kOff);
  const FirstLocalized confirmed = firstLocalized(Relocalization::kFull);
  EXPECT_EQ(confirmed.reason_before, "a second search of the map has not agreed yet");
  EXPECT_NE(unconfirmed.reason_before, confirmed.reason_before);
  EXPECT_LT(confirmed.error, 0.2);
}

TEST_P(GlobalStartTest, TheSecondSearchFollowsChangedParameters) {
  LocalizerParameters changed = parameters_;
  changed.filter.num_particles = 100;
  changed.filter.max_particles = 500;
  const auto scansUntilLocalized = [&](const LocalizerParameters& first) {
    Random random(3);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive drive(course_, first, {}, pose, 3.0, 3);
    drive.localizer().setParameters(changed, drive.localizer().map());
    EXPECT_TRUE(drive.localizer().initializeGlobally());
    int scans = 0;
    drive.drive(4.0, [&](const Observation&) {
      scans += drive.localizer().status().state != LocalizationState::kLocalized;
    });
    return scans;
  };
  EXPECT_EQ(scansUntilLocalized(parameters_), scansUntilLocalized(changed));
}

TEST_P(GlobalStartTest, IsCorrectedByASecondSearch) {
  parameters_.relocalization = Relocalization::kStart;
  for (const std::uint64_t seed : {3, 4}) {
    Random random(seed);
    const auto somewhere = [&] { return sim::randomFreePose(*course_.world, {}, random, 0.3); };
    SimulatedDrive drive(course_, parameters_, {}, somewhere(), 3.0, seed);
    EXPECT_TRUE(drive.localizer().initializeGlobally());
    // Kidnapped as soon as a pose is found, which makes that pose wrong.
    bool carried = false;
    bool believed = false;
    double error = 0.0;
    drive.drive(8.0, [&](const Observation& seen) {
      error = seen.error;
      const LocalizationStatus& status = seen.result.status;
      if (carried) {
        believed |= status.state == LocalizationState::kLocalized;
        EXPECT_TRUE(status.state != LocalizationState::kLocalized || error < 0.5) << seed;
      } else if (status.reason.rfind("a second search", 0) == 0) {
        drive.simulator().place(somewhere());
        carried = true;
      }
    });
    EXPECT_TRUE(carried) << seed;
    EXPECT_TRUE(believed) << seed << ": " << drive.localizer().status().reason;
    EXPECT_LT(error, 0.2) << seed;
    EXPECT_GE(drive.localizer().counters().recoveries, 1u) << seed;
  }
}

TEST_P(GlobalStartTest, NeedsNoSecondSearchOnceItIsToldWhereItIs) {
  Random random(3);
  const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
  SimulatedDrive drive(course_, parameters_, {}, pose, 3.0, 3);
  EXPECT_TRUE(drive.localizer().initializeGlobally());
  bool told = false;
  drive.drive(4.0, [&](const Observation& seen) {
    const bool asked = seen.result.status.reason.rfind("a second search", 0) == 0;
    EXPECT_FALSE(told && asked);
    if (!asked || told) return;
    PoseEstimate start{seen.base_in_map, Eigen::Matrix3d::Zero()};
    start.covariance.diagonal() << 0.01, 0.01, 0.0025;
    drive.localizer().initialize(start);
    told = true;
  });
  EXPECT_TRUE(told);
  EXPECT_EQ(drive.localizer().status().state, LocalizationState::kLocalized);
}

TEST_P(GlobalStartTest, IsConfirmedWhereTheCarStands) {
  // At 27 (corridor) and 22 (track) of 40 places; the others look like several.
  int confirmed = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SimulatedDrive drive = standingDrive(seed);
    EXPECT_TRUE(drive.localizer().initializeGlobally());
    double error = 0.0;
    drive.drive(4.0, [&](const Observation& seen) { error = seen.error; });
    if (drive.localizer().status().state != LocalizationState::kLocalized) continue;
    ++confirmed;
    EXPECT_LT(error, 0.2) << seed;
  }
  EXPECT_GE(confirmed, 3);
}

TEST(AmbiguousMap, IsNeverLocalizedFromAGlobalStart) {
  const OccupancyGrid grid = Room{9.0, 6.0}.grid();  // symmetric under half a turn
  LocalizerParameters parameters;
  const Course course{std::make_shared<const sim::World>(grid),
                      makeLocalizationMap(grid, parameters)};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SimulatedDrive drive(course, parameters, {}, {3.0, 1.0, 0.0}, 2.0, seed);
    ASSERT_TRUE(drive.localizer().initializeGlobally());
    drive.drive(15.0, [&](const Observation& seen) {
      ASSERT_NE(seen.result.status.state, LocalizationState::kLocalized)
          << seed << " at " << seen.result.stamp << ", error " << seen.error;
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Maps, GlobalStartTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
