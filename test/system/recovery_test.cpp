// Kidnapped robots, covered lidars and wrong odometry on the simulated maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "offline/simulated_drive.h"

namespace racecar_mcl {
namespace {

class RecoveryTest : public ::testing::TestWithParam<const char*> {
 protected:
  /// Initialized at a random pose and driven for 1.5 s.
  SimulatedDrive localizedDrive(std::uint64_t seed) const {
    Random random(seed);
    const Pose2 pose = sim::randomFreePose(*course_.world, {}, random, 0.3);
    SimulatedDrive drive(course_, parameters_, simulator_, pose, 3.0, seed);
    PoseEstimate start{pose, Eigen::Matrix3d::Zero()};
    start.covariance.diagonal() << 0.01, 0.01, 0.0025;
    drive.localizer().initialize(start);
    drive.drive(1.5, [](const Observation&) {});
    EXPECT_EQ(drive.localizer().status().state, LocalizationState::kLocalized);
    return drive;
  }

  void kidnap(SimulatedDrive* drive, std::uint64_t seed) const {
    Random random(seed + 100);
    drive->simulator().place(sim::randomFreePose(*course_.world, {}, random, 0.3));
  }

  LocalizerParameters parameters_;
  sim::SimulatorParameters simulator_;
  Course course_ =
      loadCourse(std::string(RACECAR_MCL_SOURCE_DIR "/maps/") + GetParam() + ".yaml", parameters_);
};

TEST_P(RecoveryTest, NoticesThatItWasCarriedAwayAndFindsItself) {
  for (const std::uint64_t seed : {2, 3}) {
    SimulatedDrive drive = localizedDrive(seed);
    kidnap(&drive, seed);
    bool noticed = false;
    drive.drive(1.0, [&](const Observation& seen) {
      noticed |= seen.result.status.state != LocalizationState::kLocalized;
    });
    EXPECT_TRUE(noticed) << seed;
    double error = 0.0;
    drive.drive(1.5, [&](const Observation& seen) { error = seen.error; });
    EXPECT_LT(error, 0.2) << seed;
    EXPECT_GE(drive.localizer().counters().recoveries, 1u);
  }
}

TEST_P(RecoveryTest, FindsItselfWhereItWasPushedAside) {
  for (const std::uint64_t seed : {2, 3, 4}) {
    SimulatedDrive drive = localizedDrive(seed);
    const Pose2 truth = drive.simulator().truth().base_in_map;
    drive.simulator().place(compose(truth, {0.0, seed % 2 == 0 ? 0.4 : -0.4, 0.1}));
    double error = 1.0;
    // The median is 0.8 s.
    drive.drive(4.0, [&](const Observation& seen) { error = seen.error; });
    EXPECT_LT(error, 0.1) << seed;
    EXPECT_EQ(drive.localizer().status().state, LocalizationState::kLocalized) << seed;
  }
}

TEST_P(RecoveryTest, StaysLostWhereItIsNotToSearch) {
  parameters_.relocalization = Relocalization::kStart;
  SimulatedDrive drive = localizedDrive(2);
  kidnap(&drive, 2);
  drive.drive(3.0, [](const Observation&) {});
  EXPECT_NE(drive.localizer().status().state, LocalizationState::kLocalized);
  EXPECT_EQ(drive.localizer().counters().recoveries, 0u);
}

TEST_P(RecoveryTest, SaysThatACoveredLidarSeesNothing) {
  SimulatedDrive drive = localizedDrive(2);
  drive.on_scan = [](Scan* scan) {
    scan->ranges.setConstant(0.1f);
    return true;
  };
  drive.drive(0.2, [](const Observation&) {});
  EXPECT_EQ(drive.localizer().status().state, LocalizationState::kDegraded);
}

TEST_P(RecoveryTest, FollowsTheScansWhereOdometryIsOffByHalf) {
  const auto greatestError = [this](std::uint64_t seed) {
    SimulatedDrive drive = localizedDrive(seed);
    drive.on_odometry = [](OdometrySample* sample) {
      sample->twist.vx *= 1.5;
      return true;
    };
    double greatest = 0.0;
    drive.drive(3.0, [&](const Observation& seen) { greatest = std::max(greatest, seen.error); });
    return greatest;
  };
  // The median, because featureless corridors leave the longitudinal error unobservable.
  const auto median = [&] {
    std::vector<double> errors;
    for (std::uint64_t seed = 2; seed < 7; ++seed) errors.push_back(greatestError(seed));
    std::sort(errors.begin(), errors.end());
    return errors[2];
  };
  EXPECT_LT(median(), 0.05);
  // What else follows the scans.
  parameters_.motion.slip_noise_from_speed = 0.0;
  parameters_.calibration.calibration_distance = 0.0;
  parameters_.slip_compensation = false;
  const double unadapted = median();
  parameters_.noise_adaptation = true;
  const double adapted = median();
  EXPECT_LT(adapted, 0.3);
  EXPECT_LT(adapted, 0.5 * unadapted);
}

TEST_P(RecoveryTest, FollowsTheScansWhereOdometryIsFrozen) {
  const auto greatestError = [this](std::uint64_t seed) {
    SimulatedDrive drive = localizedDrive(seed);
    drive.on_odometry = [](OdometrySample* sample) {
      sample->twist = {};
      return true;
    };
    double greatest = 0.0;
    drive.drive(3.0, [&](const Observation& seen) { greatest = std::max(greatest, seen.error); });
    EXPECT_NE(drive.localizer().status().state, LocalizationState::kLocalized);
    return greatest;
  };
  for (const double rate : {10.0, 40.0}) {
    simulator_.lidar.rate = rate;
    for (std::uint64_t seed = 2; seed < 5; ++seed) {
      EXPECT_LT(greatestError(seed), 0.15) << rate << " Hz, " << seed;
    }
  }
  parameters_.slip_compensation = false;
  EXPECT_GT(greatestError(2), 1.0);
}

TEST_P(RecoveryTest, CarriesThePoseWithTheNoiseOfWheelsThatScansContradict) {
  parameters_.motion.slip_noise_from_speed = 0.0;
  parameters_.slip_compensation = false;
  const auto growth = [this](bool noise_adaptation) {
    parameters_.noise_adaptation = noise_adaptation;
    SimulatedDrive drive = localizedDrive(4);
    drive.on_odometry = [](OdometrySample* sample) {
      sample->twist.vx *= 1.5;
      return true;
    };
    double largest = 0.0;
    drive.drive(0.5, [&](const Observation& seen) {
      const Localizer& localizer = drive.localizer();
      const auto traceAt = [&](double stamp) {
        return localizer.estimateAt(stamp)->covariance.trace();
      };
      const double stamp = seen.result.stamp;
      largest = std::max(largest, traceAt(stamp + 0.1) - traceAt(stamp));
    });
    return largest;
  };
  EXPECT_GT(growth(true), 2.0 * growth(false));
}

TEST_P(RecoveryTest, DoesNotSearchOnAGoodDrive) {
  SimulatedDrive drive = localizedDrive(4);
  drive.drive(2.0, [&](const Observation& seen) {
    ASSERT_EQ(seen.result.status.state, LocalizationState::kLocalized);
  });
  EXPECT_EQ(drive.localizer().counters().recoveries, 0u);
}

INSTANTIATE_TEST_SUITE_P(Maps, RecoveryTest, ::testing::Values("corridor", "track"),
                         [](const auto& map) { return std::string(map.param); });

}  // namespace
}  // namespace racecar_mcl
