// Inputs that stop: nobody is told `localized` any longer, on the topic and in the diagnostics.
#include <diagnostic_msgs/DiagnosticStatus.h>

#include "support/ear.h"
#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

class LocalizationSilenceTest : public LocalizationTest {
 protected:
  void SetUp() override {
    startLocalized();
    drive(1.0);
    expectVerdict("localized");
    ASSERT_FALSE(HasFatalFailure());
  }

  /// Odometry and scans at the pace of the clock, as far as they are wanted.
  void driveLive(double seconds, bool odometry, const sensor_msgs::LaserScan* scan) {
    for (int tick = 0; tick < std::lround(seconds * 50.0); ++tick) {
      ros::WallDuration(0.02).sleep();
      car_.advance(0.02);
      if (odometry) odometry_.publish(car_.odometry());
      if (scan) scans_.publish(*scan);
    }
  }

  void expectVerdict(const std::string& state) {
    listener_.waitFor([&] { return verdict_.newest().message == state; });
    EXPECT_EQ(verdict_.newest().message, state);
    EXPECT_TRUE(listener_.waitForDiagnostic("verdict", state)) << listener_.diagnostic("verdict");
  }

  void expectDegraded(const std::string& reason) {
    expectVerdict("degraded");
    EXPECT_EQ(verdict_.newest().level, diagnostic_msgs::DiagnosticStatus::WARN);
    // Where everything stops, odometry may be missed a moment before the scans are.
    listener_.waitFor([&] { return listener_.diagnostic("reason").rfind(reason, 0) == 0; });
    EXPECT_EQ(listener_.diagnostic("reason").rfind(reason, 0), 0U)
        << listener_.diagnostic("reason");
    EXPECT_EQ(listener_.diagnostics().message.rfind("degraded: " + reason, 0), 0U)
        << listener_.diagnostics().message;
    EXPECT_EQ(listener_.diagnostics().level, diagnostic_msgs::DiagnosticStatus::WARN);
  }

  Ear<diagnostic_msgs::DiagnosticStatus> verdict_{handle_, "pf/verdict"};
};

TEST_F(LocalizationSilenceTest, IsDegradedWhereScansStopAndOdometryGoesOn) {
  const std::size_t before = listener_.poses().size();
  driveLive(1.5, true, nullptr);
  expectDegraded("no usable scan for ");
  EXPECT_GT(listener_.poses().size(), before + 50) << "odometry carries the pose on";
  drive(0.2);
  expectVerdict("localized");
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
  expectVerdict("localized");
}

TEST_F(LocalizationSilenceTest, IsDegradedWhereEverythingStops) {
  expectDegraded("no usable scan for ");
}

TEST_F(LocalizationSilenceTest, ANewStartIsConvergingThoughNoScanComes) {
  expectDegraded("no usable scan for ");
  initial_pose_.publish(startMessage(car_.baseInMap()));
  expectVerdict("converging");
  EXPECT_EQ(listener_.diagnostic("reason").rfind("no usable scan for ", 0), 0U);
}

}  // namespace
}  // namespace racecar_mcl
