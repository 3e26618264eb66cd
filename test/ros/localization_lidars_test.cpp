// A car with two lidars: on two topics, and on one topic with two frames.
#include <diagnostic_msgs/DiagnosticStatus.h>

#include "racecar_mcl/common/errors.h"
#include "support/localization_fixture.h"
#include "support/message_recorder.h"

namespace racecar_mcl {
namespace {

class LocalizationLidarsTest : public LocalizationTest {
 protected:
  /// Sends the rear lidar's tf and scans as well.
  void startWithRearLidar(const std::vector<std::string>& topics) {
    XmlRpc::XmlRpcValue list;
    for (std::size_t i = 0; i < topics.size(); ++i) list[static_cast<int>(i)] = topics[i];
    parameters_.setParam("scan_topics", list);
    rear_scans_ = handle_.advertise<sensor_msgs::LaserScan>(topics.back(), 10);
    select(1);
    static_transforms_.sendTransform(car_.laserInBase());
    select(0);
    startLocalized();
  }

  void select(int lidar) {
    car_.laser_frame = lidar == 0 ? "laser" : "laser_rear";
    car_.extrinsics.laser_in_base = lidar == 0 ? Pose2{0.25, 0.05, 0.1} : Pose2{-0.1, 0.0, kPi};
  }

  sensor_msgs::LaserScan rearScan() {
    select(1);
    const sensor_msgs::LaserScan scan = car_.scan();
    select(0);
    return scan;
  }

  /// Waits for the answers. Scans of both lidars have the same stamp.
  void driveWithBoth(double seconds) {
    for (int tick = 0; tick < std::lround(seconds * 25.0); ++tick) {
      car_.advance(0.02);
      odometry_.publish(car_.odometry());
      car_.advance(0.02);
      odometry_.publish(car_.odometry());
      EXPECT_TRUE(sendScan(car_.scan()));
      const std::size_t before = listener_.scanPoseCount();
      rear_scans_.publish(rearScan());
      EXPECT_TRUE(listener_.waitFor([&] { return listener_.scanPoseCount() > before; }));
    }
  }

  /// In real time, with the front lidar only.
  void driveLiveWithoutRear(double seconds) {
    for (int tick = 0; tick < std::lround(seconds * 25.0); ++tick) {
      ros::WallDuration(0.04).sleep();
      car_.advance(0.04);
      odometry_.publish(car_.odometry());
      sendScan(car_.scan());
    }
  }

  ros::Publisher rear_scans_;
  MessageRecorder<diagnostic_msgs::DiagnosticStatus> status_{handle_, "pf/status"};
};

TEST_F(LocalizationLidarsTest, ASilentLidarIsNamedAndThePoseKept) {
  startWithRearLidar({"scan", "scan_rear"});
  driveWithBoth(1.0);
  expectLocalized();
  listener_.waitFor([&] { return listener_.diagnostic("laser_rear: lidar scans used") == "25"; });
  EXPECT_EQ(listener_.diagnostic("laser_rear: lidar scans used"), "25");
  EXPECT_EQ(listener_.diagnostic("laser_rear: lidar topic"), "scan_rear");
  EXPECT_EQ(listener_.diagnostic("laser: lidar topic"), "scan");
  EXPECT_NE(listener_.diagnostic("laser: range bias (m)"), "");
  EXPECT_NE(listener_.diagnostic("laser_rear: range bias (m)"), "");
  EXPECT_EQ(listener_.diagnostic("laser_rear: scan direction"), "listed");

  driveLiveWithoutRear(1.6);
  const std::string silence = "no usable scan of laser_rear for ";
  EXPECT_TRUE(listener_.waitForLog("no usable scan of laser_rear"));
  listener_.waitFor(
      [&] { return listener_.diagnostic("reason").find(silence) != std::string::npos; });
  EXPECT_NE(listener_.diagnostic("reason").find(silence), std::string::npos);
  EXPECT_EQ(listener_.diagnostic("status"), "localized");
  EXPECT_EQ(listener_.diagnostic("silent lidars"), "laser_rear");
  EXPECT_EQ(listener_.diagnostics().level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_EQ(status_.newest().message, "localized");
  expectLocalized();

  driveWithBoth(0.2);
  EXPECT_TRUE(listener_.waitForDiagnostic("silent lidars", ""));
  EXPECT_EQ(listener_.diagnostics().level, diagnostic_msgs::DiagnosticStatus::OK);
}

TEST_F(LocalizationLidarsTest, ATopicWithoutScansIsNamed) {
  parameters_.setParam("scan_topics", "scan scan_rear");
  startLocalized();
  driveLiveWithoutRear(1.6);
  listener_.waitFor([&] { return listener_.diagnostic("silent lidars") != ""; });
  EXPECT_EQ(listener_.diagnostic("silent lidars"), "scan_rear");
  expectLocalized();
}

TEST_F(LocalizationLidarsTest, FramesDistinguishLidarsOnOneTopic) {
  startWithRearLidar({"scan"});
  driveWithBoth(1.0);
  expectLocalized();
  listener_.waitFor([&] { return listener_.diagnostic("laser_rear: lidar scans used") == "25"; });
  EXPECT_EQ(listener_.diagnostic("laser_rear: lidar scans used"), "25");
  EXPECT_EQ(listener_.diagnostic("laser: lidar scans used"), "25");
}

TEST_F(LocalizationLidarsTest, OneFrameOnTwoTopicsIsRefused) {
  startWithRearLidar({"scan", "scan_rear"});
  drive(0.2);
  car_.advance(0.02);
  odometry_.publish(car_.odometry());
  rear_scans_.publish(car_.scan());
  EXPECT_TRUE(listener_.waitForLog("scans on scan and on scan_rear have the frame 'laser'"));
  expectStillLocalizes();
}

TEST_F(LocalizationLidarsTest, UnusableScanTopicsAreRefused) {
  for (const char* topics : {"", "scan scan", "scan 1/2"}) {
    parameters_.setParam("scan_topics", topics);
    EXPECT_THROW(startNode(), ParameterError) << topics;
  }
}

}  // namespace
}  // namespace racecar_mcl
