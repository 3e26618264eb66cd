// What robots and people send by mistake. After each of it the node has said what was wrong, has
// counted it, and still localizes; that nothing it publishes is NaN is checked by the listener.
#include <functional>
#include <limits>

#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfF = std::numeric_limits<float>::infinity();

/// A message spoilt in one way, where that is counted, and what is said about it.
template <typename Message>
struct Mistake {
  std::string name;
  std::function<void(Message&)> spoil;
  std::string counter;
  std::string words;
};

template <typename Message>
std::ostream& operator<<(std::ostream& stream, const Mistake<Message>& mistake) {
  return stream << mistake.name;
}

template <typename Param>
std::string nameOf(const ::testing::TestParamInfo<Param>& info) {
  return info.param.name;
}

using BadScan = Mistake<sensor_msgs::LaserScan>;
class LocalizationBadScanTest : public LocalizationTest,
                                public ::testing::WithParamInterface<BadScan> {};

TEST_P(LocalizationBadScanTest, IsDroppedCountedAndNamed) {
  startLocalized();
  expectStillLocalizes();
  for (int i = 0; i < 3; ++i) {
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
  EXPECT_EQ(listener_.logged(GetParam().words), 1) << "said once, not with every scan";
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
                "scans unreadable", "though angle_max lies above angle_min"},
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
                "tf does not say where"},
        BadScan{"WithoutAStamp", [](auto& scan) { scan.header.stamp = ros::Time(); },
                "stamps refused", "carries no stamp"},
        BadScan{"FromTheFuture", [](auto& scan) { scan.header.stamp.sec = 4294967295U; },
                "stamps refused", "ahead of the clock"}),
    nameOf<BadScan>);

class LocalizationBadInputTest : public LocalizationTest {
 protected:
  void SetUp() override {
    startLocalized();
    expectStillLocalizes();
  }

  /// Sends one message that must not be taken.
  void sendOdometry(const std::function<void(nav_msgs::Odometry&)>& spoil) {
    nav_msgs::Odometry message = car_.odometry();
    spoil(message);
    odometry_.publish(message);
  }

  /// Counters of what the test's set-up has used up; the tests look at differences.
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
  EXPECT_FALSE(sendScan(car_.scan(), 0.1)) << "the stamp of the last scan again";
  EXPECT_TRUE(listener_.waitForLog("scan stamp repeats"));
  sensor_msgs::LaserScan late = car_.scan();
  late.header.stamp -= ros::Duration(0.1);
  EXPECT_FALSE(sendScan(late, 0.1));
  EXPECT_TRUE(listener_.waitForDiagnostic("scans dropped", std::to_string(scans + 2)));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, OdometryFromTheFutureIsDropped) {
  sendOdometry([](auto& message) { message.header.stamp.sec = 4294967295U; });
  EXPECT_TRUE(listener_.waitForDiagnostic("stamps refused", "1"));
  EXPECT_TRUE(listener_.waitForLog("ahead of the clock"));
  expectStillLocalizes();
}

TEST_F(LocalizationBadInputTest, OdometryWithoutAStampIsDropped) {
  sendOdometry([](auto& message) { message.header.stamp = ros::Time(); });
  EXPECT_TRUE(listener_.waitForDiagnostic("stamps refused", "1"));
  EXPECT_TRUE(listener_.waitForLog("odometry dropped: it carries no stamp"));
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

TEST_F(LocalizationBadInputTest, ATiltedLidarIsRefused) {
  geometry_msgs::TransformStamped tilted = car_.laserInBase();
  tilted.child_frame_id = "tilted_laser";
  tilted.transform.rotation.x = tilted.transform.rotation.w = std::sqrt(0.5);
  tilted.transform.rotation.y = tilted.transform.rotation.z = 0.0;
  static_transforms_.sendTransform(tilted);
  car_.advance(0.02);
  sensor_msgs::LaserScan scan = car_.scan();
  scan.header.frame_id = "tilted_laser";
  // Until tf has arrived the frame is unknown instead.
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

class LocalizationLiveClockTest : public LocalizationTest {};

TEST_F(LocalizationLiveClockTest, SetBackWhileDrivingMovesNobodyToInitialPose) {
  parameters_.setParam("initial_pose", "3.0 3.0 0.0");
  car_.setStamp(ros::WallTime::now().toSec());
  startLocalized();
  expectStillLocalizes();
  car_.setStamp(ros::WallTime::now().toSec() - 4.0);
  expectStillLocalizes();
  EXPECT_EQ(listener_.logged("as when a clock is set"), 1);
}

using Start = geometry_msgs::PoseWithCovarianceStamped;
using BadStart = Mistake<Start>;
class LocalizationBadStartTest : public LocalizationTest,
                                 public ::testing::WithParamInterface<BadStart> {};

TEST_P(LocalizationBadStartTest, IsRefusedCountedAndNamed) {
  startLocalized();
  expectStillLocalizes();
  Start message = startMessage(compose(roomInMap(), {2.0, 2.0, 0.0}));
  GetParam().spoil(message);
  initial_pose_.publish(message);
  EXPECT_TRUE(listener_.waitForLog(GetParam().words));
  EXPECT_TRUE(listener_.waitForDiagnostic("start poses refused", "1"));
  EXPECT_EQ(listener_.logged("localizing from"), 1);
  expectStillLocalizes();
}

INSTANTIATE_TEST_SUITE_P(
    , LocalizationBadStartTest,
    ::testing::Values(BadStart{"ZeroQuaternion",
                               [](auto& m) {
                                 m.pose.pose.orientation = geometry_msgs::Quaternion();
                               },
                               "", "is no orientation"},
                      BadStart{"NanQuaternion", [](auto& m) { m.pose.pose.orientation.z = kNan; },
                               "", "is no orientation"},
                      BadStart{"NanPosition", [](auto& m) { m.pose.pose.position.x = kNan; }, "",
                               "must be finite"},
                      BadStart{"InfiniteCovariance", [](auto& m) { m.pose.covariance[35] = kInfF; },
                               "", "covariance holds NaN or inf"},
                      BadStart{"NegativeVariance", [](auto& m) { m.pose.covariance[7] = -1.0; }, "",
                               "negative eigenvalue"},
                      BadStart{"OutsideTheMap", [](auto& m) { m.pose.pose.position.x = 50.0; }, "",
                               "lies outside the map"},
                      BadStart{"BeyondAllBounds", [](auto& m) { m.pose.pose.position.x = 1e300; },
                               "", "start refused"},
                      BadStart{"InAnotherFrame", [](auto& m) { m.header.frame_id = "odom"; }, "",
                               "given in frame 'odom'; expected 'map'"},
                      BadStart{"WithoutAFrame", [](auto& m) { m.header.frame_id.clear(); }, "",
                               "given in frame ''; expected 'map'"}),
    nameOf<BadStart>);

using BadMap = Mistake<nav_msgs::OccupancyGrid>;
class LocalizationBadMapTest : public LocalizationTest,
                               public ::testing::WithParamInterface<BadMap> {};

TEST_P(LocalizationBadMapTest, LeavesTheOldMapInPlace) {
  startLocalized();
  expectStillLocalizes();
  nav_msgs::OccupancyGrid message = toMessage(testRoom(), "map", ros::Time(1.0));
  GetParam().spoil(message);
  map_.publish(message);
  EXPECT_TRUE(listener_.waitForLog("map refused"));
  EXPECT_TRUE(listener_.waitForLog(GetParam().words));
  EXPECT_TRUE(listener_.waitForDiagnostic("maps refused", "1"));
  expectStillLocalizes();
}

TEST_P(LocalizationBadMapTest, LeavesTheNodeWaitingForAnother) {
  parameters_.setParam("global_start", true);
  startNode();
  nav_msgs::OccupancyGrid message = toMessage(testRoom(), "map", ros::Time(1.0));
  GetParam().spoil(message);
  map_.publish(message);
  EXPECT_TRUE(listener_.waitForLog("map refused"));
  EXPECT_EQ(listener_.diagnostics().message, "waiting for a map");
  publishMap();
  EXPECT_TRUE(listener_.waitForLog("localizing globally"));
}

INSTANTIATE_TEST_SUITE_P(
    , LocalizationBadMapTest,
    ::testing::Values(
        BadMap{"WithoutAFreeCell",
               [](auto& m) {
                 for (auto& cell : m.data) cell = 100;
               },
               "", "no free cell"},
        BadMap{"Unknown",
               [](auto& m) {
                 for (auto& cell : m.data) cell = -1;
               },
               "", "no free cell"},
        BadMap{"ZeroSize",
               [](auto& m) {
                 m.info.width = m.info.height = 0;
                 m.data.clear();
               },
               "", "0 x 0"},
        BadMap{"HugeSize", [](auto& m) { m.info.width = m.info.height = 4000000000U; }, "",
               "4000000000"},
        BadMap{"FewerCellsThanItSays", [](auto& m) { m.data.resize(7); }, "", "7"},
        BadMap{"ZeroResolution", [](auto& m) { m.info.resolution = 0.0f; }, "", "resolution"},
        BadMap{"NegativeResolution", [](auto& m) { m.info.resolution = -0.05f; }, "", "resolution"},
        BadMap{"NanResolution", [](auto& m) { m.info.resolution = kNanF; }, "", "resolution"},
        BadMap{"NanOrigin", [](auto& m) { m.info.origin.position.y = kNan; }, "", "origin"},
        BadMap{"ZeroQuaternion",
               [](auto& m) { m.info.origin.orientation = geometry_msgs::Quaternion(); }, "",
               "origin"}),
    nameOf<BadMap>);

}  // namespace
}  // namespace racecar_mcl
