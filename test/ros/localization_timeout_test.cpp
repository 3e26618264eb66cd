// Input timeouts: the status on the topic and in the diagnostics becomes `degraded`.
#include <diagnostic_msgs/DiagnosticStatus.h>

#include "support/localization_fixture.h"
#include "support/message_recorder.h"

namespace racecar_mcl {
namespace {

class LocalizationSilenceTest : public LocalizationTest {
 protected:
  void SetUp() override {
    startLocalized();
    drive(1.0);
    expectStatus("localized");
    ASSERT_FALSE(HasFatalFailure());
  }

  /// Sends the selected inputs, odometry and scans, in real time.
  void driveLive(double seconds, bool odometry, const sensor_msgs::LaserScan* scan) {
    for (int tick = 0; tick < std::lround(seconds * 50.0); ++tick) {
      ros::WallDuration(0.02).sleep();
      car_.advance(0.02);
      if (odometry) odometry_.publish(car_.odometry());
      if (scan) scans_.publish(*scan);
    }
  }

  void expectStatus(const std::string& state) {
    listener_.waitFor([&] { return status_.newest().message == state; });
    EXPECT_EQ(status_.newest().message, state);
    EXPECT_TRUE(listener_.waitForDiagnostic("status", state)) << listener_.diagnostic("status");
  }

  void expectDegraded(const std::string& reason) {
    expectStatus("degraded");
    EXPECT_EQ(status_.newest().level, diagnostic_msgs::DiagnosticStatus::WARN);
    // If both inputs stop, the odometry timeout may be reported first.
    listener_.waitFor([&] { return listener_.diagnostic("reason").rfind(reason, 0) == 0; });
    EXPECT_EQ(listener_.diagnostic("reason").rfind(reason, 0), 0U)
        << listener_.diagnostic("reason");
    EXPECT_EQ(listener_.diagnostics().message.rfind("degraded: " + reason, 0), 0U)
        << listener_.diagnostics().message;
    EXPECT_EQ(listener_.diagnostics().level, diagnostic_msgs::DiagnosticStatus::WARN);
  }

  MessageRecorder<diagnostic_msgs::DiagnosticStatus> status_{handle_, "pf/status"};
};

TEST_F(LocalizationSilenceTest, IsDegradedWhereScansStopAndOdometryGoesOn) {
  const std::size_t before = listener_.poses().size();
  driveLive(1.5, true, nullptr);
  expectDegraded("no usable scan for ");
  EXPECT_GT(listener_.poses().size(), before + 50) << "the pose is predicted by odometry";
  drive(0.2);
  expectStatus("localized");
}

TEST_F(LocalizationSilenceTest, IsDegradedWhereNoScanCanBeUsed) {
  sensor_msgs::LaserScan spoilt = car_.scan();
  spoilt.angle_increment = 0.0f;
  driveLive(1.5, true, &spoilt);
  expectDegraded("no usable scan for ");
}

TEST_F(LocalizationSilenceTest, IsDegradedWhereOneScanIsRepeatedForEver) {
  const sensor_msgs::LaserScan frozen = car_.scan();
  driveLive(1.5, true, &frozen);
  expectDegraded("no usable scan for ");
}

TEST_F(LocalizationSilenceTest, IsDegradedWhereOdometryStopsAndScansGoOn) {
  car_.twist = {};
  drive(0.2);
  for (int i = 0; i < 40; ++i) {
    driveLive(0.04, false, nullptr);
    sendScan(car_.scan());
  }
  expectDegraded("no usable odometry for ");
  drive(0.2);
  expectStatus("localized");
}

TEST_F(LocalizationSilenceTest, IsDegradedWhereEverythingStops) {
  expectDegraded("no usable scan for ");
}

TEST_F(LocalizationSilenceTest, ANewStartIsInitializingThoughNoScanComes) {
  expectDegraded("no usable scan for ");
  initial_pose_.publish(startMessage(car_.baseInMap()));
  expectStatus("initializing");
  EXPECT_EQ(listener_.diagnostic("reason").rfind("no usable scan for ", 0), 0U);
}

}  // namespace
}  // namespace racecar_mcl
