// Invalid scans and odometry. The node must log and count each case and continue to localize; the
// listener checks that nothing it publishes is NaN.
#include <functional>

#include "support/localization_fixture.h"
#include "support/mistake.h"

namespace racecar_mcl {
namespace {

using Start = geometry_msgs::PoseWithCovarianceStamped;
using BadScan = Mistake<sensor_msgs::LaserScan>;
class LocalizationBadScanTest : public LocalizationTest,
                                public ::testing::WithParamInterface<BadScan> {};

TEST_P(LocalizationBadScanTest, IsDroppedCountedAndNamed) {
  startLocalized();
  expectStillLocalizes();
  for (int i = 0; i < 3; ++i) {
    // A missing transform may still arrive in the first seconds.
    if (i == 2 && GetParam().counter == "scans without tf") ros::WallDuration(2.1).sleep();
    car_.advance(0.02);
    odometry_.publish(car_.odometry());
    sensor_msgs::LaserScan scan = car_.scan();
    GetParam().spoil(scan);
    EXPECT_FALSE(sendScan(scan, 0.05));
  }
  EXPECT_TRUE(listener_.waitForDiagnostic(GetParam().counter, "3"));
  EXPECT_NE(listener_.diagnostic("last problem").find(GetParam().words), std::string::npos)
      << listener_.diagnostic("last problem");
  EXPECT_TRUE(listener_.waitForLog(GetParam().words));
  EXPECT_EQ(listener_.logged(GetParam().words), 1) << "throttled: logged once";
  expectStillLocalizes();
}

INSTANTIATE_TEST_SUITE_P(
    , LocalizationBadScanTest,
    ::testing::Values(
        BadScan{"Empty", [](auto& scan) { scan.ranges.clear(); }, "scans unreadable", "empty"},
        BadScan{"OneRange", [](auto& scan) { scan.ranges.resize(1); }, "scans dropped",
                "too few valid beams"},
        BadScan{"OnlyNan",
                [](auto& scan) {
                  for (float& range : scan.ranges) range = kNanF;
                },
                "scans dropped", "too few valid beams"},
        BadScan{"ZeroIncrement", [](auto& scan) { scan.angle_increment = 0.0f; },
                "scans unreadable", "angle_increment is 0"},
        BadScan{"NegativeIncrement", [](auto& scan) { scan.angle_increment *= -1.0f; },
                "scans unreadable", "but angle_max is greater than angle_min"},
        BadScan{"NanIncrement", [](auto& scan) { scan.angle_increment = kNanF; },
                "scans unreadable", "angle_increment is nan"},
        BadScan{"InfiniteAngle", [](auto& scan) { scan.angle_min = kInfF; }, "scans unreadable",
                "angle_min is inf"},
        BadScan{"ManyTurns", [](auto& scan) { scan.angle_increment = 1.0f; }, "scans unreadable",
                "at most two turns"},
        BadScan{"NegativeTimeIncrement", [](auto& scan) { scan.time_increment = -1e-5f; },
                "scans unreadable", "time_increment"},
        BadScan{"NoRangeBetweenMinAndMax",
                [](auto& scan) { std::swap(scan.range_min, scan.range_max); }, "scans unreadable",
                "leave no valid range"},
        BadScan{"NanRangeMax", [](auto& scan) { scan.range_max = kNanF; }, "scans unreadable",
                "leave no valid range"},
        BadScan{"UnknownFrame", [](auto& scan) { scan.header.frame_id = "nobodys_laser"; },
                "scans without tf", "'nobodys_laser'"},
        BadScan{"NoFrame", [](auto& scan) { scan.header.frame_id.clear(); }, "scans without tf",
                "the scan has no frame_id"},
        BadScan{"WithoutAStamp", [](auto& scan) { scan.header.stamp = ros::Time(); },
                "stamps rejected", "stamp is zero"},
        BadScan{"FromTheFuture", [](auto& scan) { scan.header.stamp.sec = 4294967295U; },
                "stamps rejected", "ahead of the clock"}),
    nameOf<BadScan>);

class LocalizationBadInputTest : public LocalizationTest {
 protected:
  void SetUp() override {
    startLocalized();
    expectStillLocalizes();
  }

  /// Sends an odometry message that must be rejected.
  void sendOdometry(const std::function<void(nav_msgs::Odometry&)>& spoil) {
    nav_msgs::Odometry message = car_.odometry();
    spoil(message);
    odometry_.publish(message);
  }

  /// The value of a counter; SetUp has already increased some of them.
  int diagnostic(const std::string& key) { return std::atoi(listener_.diagnostic(key).c_str()); }
};

TEST_F(LocalizationBadInputTest, RangesThatAreNoneAreLeftOutOfAScan) {
  for (int i = 0; i < 25; ++i) {
    car_.advance(0.02);
    odometry_.publish(car_.odometry());
    car_.advance(0.02);
    odometry_.publish(car_.odometry());
    sensor_msgs::LaserScan scan = car_.scan();
    for (std::size_t k = 0; k + 5 < scan.ranges.size(); k += 10) {
      scan.ranges[k] = kNanF;
      scan.ranges[k + 1] = -kInfF;
      scan.ranges[k + 2] = -3.0f;
      scan.ranges[k + 3] = 0.0f;
    }
    EXPECT_TRUE(sendScan(scan));
  }
  expectLocalized();
}

TEST_F(LocalizationBadInputTest, RangesWithoutReturnOrBeyondTheLidarsReachDoNoHarm) {
  for (int i = 0; i < 25; ++i) {
    car_.advance(0.04);
    odometry_.publish(car_.odometry());
    sensor_msgs::LaserScan scan = car_.scan();
    for (std::size_t k = 0; k < scan.ranges.size(); k += 5) {
      scan.ranges[k] = k % 2 == 0 ? kInfF : 1e30f;
    }
    EXPECT_TRUE(sendScan(scan));
  }
  expectLocalized();
}

TEST_F(LocalizationBadInputTest, AScanThatSeesNothingAtAllDoesNoHarm) {
  car_.advance(0.02);
  sensor_msgs::LaserScan scan = car_.scan();
  for (float& range : scan.ranges) range = kInfF;
  sendScan(scan, 0.2);
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, ASweepTheOtherWayRoundIsAsGood) {
  for (int i = 0; i < 25; ++i) {
    car_.advance(0.02);
    odometry_.publish(car_.odometry());
    sensor_msgs::LaserScan scan = car_.scan();
    std::reverse(scan.ranges.begin(), scan.ranges.end());
    std::swap(scan.angle_min, scan.angle_max);
    scan.angle_increment *= -1.0f;
    EXPECT_TRUE(sendScan(scan));
  }
  expectLocalized();
}

TEST_F(LocalizationBadInputTest, OdometryWithoutANumberIsDropped) {
  const int dropped = diagnostic("odometry dropped");
  sendOdometry([](auto& message) { message.twist.twist.linear.x = kNan; });
  sendOdometry([](auto& message) { message.twist.twist.angular.z = -kInfF; });
  sendOdometry([](auto& message) { message.twist.twist.linear.y = 1e300; });
  EXPECT_TRUE(listener_.waitForLog("odometry holds NaN or inf"));
  EXPECT_TRUE(listener_.waitForDiagnostic("odometry dropped", std::to_string(dropped + 3)));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, OdometryWhosePoseIsNoneServesByItsTwist) {
  const int dropped = diagnostic("odometry dropped");
  for (int i = 0; i < 50; ++i) {
    car_.advance(0.02);
    sendOdometry([](auto& message) {
      message.pose.pose.orientation = geometry_msgs::Quaternion();
      message.pose.pose.position.x = kNan;
    });
    if (i % 2 == 0) {
      EXPECT_TRUE(sendScan(car_.scan()));
    }
  }
  EXPECT_EQ(diagnostic("odometry dropped"), dropped);
  expectLocalized();
}

TEST_F(LocalizationBadInputTest, RepeatedAndLateStampsAreDropped) {
  const int odometry = diagnostic("odometry dropped");
  const int scans = diagnostic("scans dropped");
  odometry_.publish(car_.odometry());
  odometry_.publish(car_.odometry());
  sendOdometry([](auto& message) { message.header.stamp -= ros::Duration(0.05); });
  EXPECT_TRUE(listener_.waitForDiagnostic("odometry dropped", std::to_string(odometry + 3)));
  EXPECT_TRUE(listener_.waitForLog("odometry stamp repeats"));
  EXPECT_FALSE(sendScan(car_.scan(), 0.1)) << "repeats the last scan's stamp";
  EXPECT_TRUE(listener_.waitForLog("scan stamp repeats"));
  sensor_msgs::LaserScan late = car_.scan();
  late.header.stamp -= ros::Duration(0.1);
  EXPECT_FALSE(sendScan(late, 0.1));
  EXPECT_TRUE(listener_.waitForDiagnostic("scans dropped", std::to_string(scans + 2)));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, OdometryFromTheFutureIsDropped) {
  sendOdometry([](auto& message) { message.header.stamp.sec = 4294967295U; });
  EXPECT_TRUE(listener_.waitForDiagnostic("stamps rejected", "1"));
  EXPECT_TRUE(listener_.waitForLog("ahead of the clock"));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, OdometryWithoutAStampIsDropped) {
  sendOdometry([](auto& message) { message.header.stamp = ros::Time(); });
  EXPECT_TRUE(listener_.waitForDiagnostic("stamps rejected", "1"));
  EXPECT_TRUE(listener_.waitForLog("odometry dropped: the stamp is zero"));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, AScanFloodIsAnsweredByTheNewestScan) {
  for (int i = 0; i < 300; ++i) {
    car_.advance(0.002);
    odometry_.publish(car_.odometry());
    scans_.publish(car_.scan());
  }
  EXPECT_TRUE(listener_.waitFor([&] {
    return distance(toPose2(listener_.newestPose()->pose.pose), car_.baseInMap()) < 0.1;
  }));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, ScansOfAnotherClockAreNamed) {
  for (int i = 0; i < 10; ++i) {
    car_.advance(0.04);
    odometry_.publish(car_.odometry());
    sensor_msgs::LaserScan scan = car_.scan();
    scan.header.stamp -= ros::Duration(37.0);
    sendScan(scan, 0.1);
  }
  EXPECT_TRUE(listener_.waitForLog("s behind the newest odometry; expected stamps of one clock"));
}

TEST_F(LocalizationBadInputTest, ATiltedLidarIsRefused) {
  geometry_msgs::TransformStamped tilted = car_.laserInBase();
  tilted.child_frame_id = "tilted_laser";
  tilted.transform.rotation.x = tilted.transform.rotation.w = std::sqrt(0.5);
  tilted.transform.rotation.y = tilted.transform.rotation.z = 0.0;
  static_transforms_.sendTransform(tilted);
  car_.advance(0.02);
  sensor_msgs::LaserScan scan = car_.scan();
  scan.header.frame_id = "tilted_laser";
  // Until tf arrives, the frame is unknown.
  EXPECT_TRUE(listener_.waitFor([&] {
    sendScan(scan, 0.02);
    return listener_.diagnostic("last problem").find("tilted by") != std::string::npos;
  }));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, AMapInAnotherFrameIsNamed) {
  nav_msgs::OccupancyGrid message = toMessage(testRoom(), "world", ros::Time(1.0));
  map_.publish(message);
  EXPECT_TRUE(listener_.waitForLog("the map is given in 'world' but poses in 'map'"));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, AFloodOfRefusalsGivesAFewShortLines) {
  const int before = listener_.logged("");
  const int lines_before = listener_.logged("\n");
  const ros::WallTime begin = ros::WallTime::now();
  Start start = startMessage(car_.baseInMap());
  for (int i = 0; i < 1500; ++i) {
    const std::string frame = "odom\n[ERROR] forged " + std::to_string(i) +
                              (i % 100 == 0 ? std::string(1000000, 'x') : std::string());
    start.header.frame_id = i % 2 == 0 ? frame : "map";
    start.pose.pose.position.x = i % 4 == 1 ? 50.0 + i : car_.baseInMap().x;
    initial_pose_.publish(start);
    sensor_msgs::LaserScan scan = car_.scan();
    scan.header.frame_id = frame;
    scans_.publish(scan);
    sendOdometry([&](auto& message) {
      message.header.stamp += ros::Duration(5.0 * (i / 2 % 2));
      message.header.stamp += ros::Duration(0.001 * i);
    });
    ros::WallDuration(0.001).sleep();
  }
  ros::WallDuration(0.2).sleep();
  const double seconds = (ros::WallTime::now() - begin).toSec();
  EXPECT_LE(listener_.logged("") - before, LogThrottle::kMaxLines * (seconds + 1.0));
  EXPECT_GT(listener_.logged("initialpose rejected: the frame is 'odom\\n[ERROR] forged"), 0);
  EXPECT_EQ(listener_.logged("\n"), lines_before);
  EXPECT_EQ(listener_.logged(std::string(65, 'x')), 0);
  EXPECT_LT(listener_.diagnostic("last problem").size(), 400u);
  EXPECT_EQ(listener_.diagnostic("last problem").find('\n'), std::string::npos);
  car_.advance(10.0);  // past the stamps above
  drive(0.2);
  initial_pose_.publish(startMessage(car_.baseInMap()));
  ros::WallDuration(0.2).sleep();
  expectStillLocalizes();
}

class LocalizationLiveClockTest : public LocalizationTest {};

TEST_F(LocalizationLiveClockTest, SetBackWhileDrivingMovesNobodyToInitialPose) {
  parameters_.setParam("initial_pose", "3.0 3.0 0.0");
  car_.setStamp(ros::WallTime::now().toSec());
  startLocalized();
  expectStillLocalizes();
  car_.setStamp(ros::WallTime::now().toSec() - 4.0);
  expectStillLocalizes();
  EXPECT_EQ(listener_.logged("clock set back"), 1);
}

}  // namespace
}  // namespace racecar_mcl
