#include "racecar_mcl/monitoring/input_watchdog.h"

#include <gtest/gtest.h>

namespace racecar_mcl {
namespace {

/// A watchdog with inputs at the time 100 s.
class InputWatchdogTest : public ::testing::Test {
 protected:
  InputWatchdogTest() {
    status_.state = LocalizationState::kLocalized;
    status_.reason = "95 % inliers";
    recordAll(100.0);
  }

  void recordAll(double now) {
    watchdog_.recordScan(now);
    watchdog_.recordOdometry(now);
  }

  LocalizationStatus status_;
  InputWatchdog watchdog_{1.0};
};

TEST_F(InputWatchdogTest, KeepsTheStatusWhileInputsArrive) {
  for (double now = 100.0; now < 110.0; now += 0.9) {
    const LocalizationStatus status = watchdog_.monitor(status_, now);
    EXPECT_EQ(status.state, LocalizationState::kLocalized);
    EXPECT_EQ(status.reason, status_.reason);
    recordAll(now);
  }
}

TEST_F(InputWatchdogTest, DegradesWithoutScans) {
  watchdog_.recordOdometry(101.5);
  const LocalizationStatus status = watchdog_.monitor(status_, 101.5);
  EXPECT_EQ(status.state, LocalizationState::kDegraded);
  EXPECT_EQ(status.reason, "no usable scan for 1.5 s");
  watchdog_.recordScan(101.6);
  EXPECT_EQ(watchdog_.monitor(status_, 101.6).state, LocalizationState::kLocalized);
}

TEST_F(InputWatchdogTest, DegradesWithoutOdometry) {
  watchdog_.recordScan(101.5);
  const LocalizationStatus status = watchdog_.monitor(status_, 101.5);
  EXPECT_EQ(status.state, LocalizationState::kDegraded);
  EXPECT_EQ(status.reason, "no usable odometry for 1.5 s");
}

TEST_F(InputWatchdogTest, DegradesWithoutInputs) {
  EXPECT_EQ(watchdog_.monitor(status_, 103.0).reason, "no usable scan for 3.0 s");
}

TEST_F(InputWatchdogTest, NeverImprovesTheStatus) {
  for (const LocalizationState state :
       {LocalizationState::kInitializing, LocalizationState::kDegraded, LocalizationState::kLost}) {
    status_.state = state;
    EXPECT_EQ(watchdog_.monitor(status_, 103.0).state, state);
    EXPECT_EQ(watchdog_.monitor(status_, 103.0).reason, "no usable scan for 3.0 s");
  }
}

TEST_F(InputWatchdogTest, CountsFromTheFirstCallIfThereWasNoInput) {
  InputWatchdog watchdog(1.0);
  EXPECT_EQ(watchdog.monitor(status_, 500.0).state, LocalizationState::kLocalized);
  EXPECT_EQ(watchdog.monitor(status_, 501.5).state, LocalizationState::kDegraded);
}

TEST_F(InputWatchdogTest, HandlesAClockThatStopsOrIsSetBack) {
  EXPECT_EQ(watchdog_.monitor(status_, 100.0).state, LocalizationState::kLocalized);
  EXPECT_EQ(watchdog_.monitor(status_, 20.0).state, LocalizationState::kLocalized);
  EXPECT_EQ(watchdog_.monitor(status_, 21.5).state, LocalizationState::kDegraded)
      << "counted from 20 s";
}

TEST_F(InputWatchdogTest, HandlesAClockThatStarts) {
  recordAll(0.0);
  EXPECT_EQ(watchdog_.monitor(status_, 0.0).state, LocalizationState::kLocalized);
  EXPECT_EQ(watchdog_.monitor(status_, 1000.0).state, LocalizationState::kLocalized);
}

TEST_F(InputWatchdogTest, NamesASilentLidarWhileOthersGoOn) {
  watchdog_.recordScan(100.0, "front");
  watchdog_.recordScan(100.0, "rear");
  watchdog_.expectLidar("/left");
  EXPECT_EQ(watchdog_.monitor(status_, 100.0).reason, status_.reason);
  for (double now = 100.0; now < 103.0; now += 0.5) {
    watchdog_.recordScan(now, "front");
    watchdog_.recordOdometry(now);
  }
  const LocalizationStatus status = watchdog_.monitor(status_, 103.0);
  EXPECT_EQ(status.state, LocalizationState::kLocalized);
  EXPECT_EQ(status.reason, "95 % inliers; no usable scan of /left for 3.0 s and of rear for 3.0 s");
  EXPECT_EQ(watchdog_.silentLidars(), "/left, rear");
  watchdog_.forgetLidar("/left");
  watchdog_.recordScan(103.0, "rear");
  EXPECT_EQ(watchdog_.monitor(status_, 103.0).reason, status_.reason);
  EXPECT_EQ(watchdog_.silentLidars(), "");
}

TEST_F(InputWatchdogTest, DegradesIfAllLidarsAreSilent) {
  watchdog_.recordScan(100.0, "front");
  watchdog_.recordScan(100.0, "rear");
  watchdog_.recordOdometry(103.0);
  const LocalizationStatus status = watchdog_.monitor(status_, 103.0);
  EXPECT_EQ(status.state, LocalizationState::kDegraded);
  EXPECT_EQ(status.reason, "no usable scan for 3.0 s");
}

}  // namespace
}  // namespace racecar_mcl
