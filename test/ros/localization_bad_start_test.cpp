// Invalid start poses and maps. The node must log and count each and continue to localize.
#include "support/localization_fixture.h"
#include "support/mistake.h"

namespace racecar_mcl {
namespace {

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
  EXPECT_TRUE(listener_.waitForDiagnostic("start poses rejected", "1"));
  EXPECT_EQ(listener_.logged("localizing from"), 1);
  expectStillLocalizes();
}

INSTANTIATE_TEST_SUITE_P(
    , LocalizationBadStartTest,
    ::testing::Values(BadStart{"ZeroQuaternion",
                               [](auto& m) {
                                 m.pose.pose.orientation = geometry_msgs::Quaternion();
                               },
                               "", "is not an orientation"},
                      BadStart{"NanQuaternion", [](auto& m) { m.pose.pose.orientation.z = kNan; },
                               "", "is not an orientation"},
                      BadStart{"NanPosition", [](auto& m) { m.pose.pose.position.x = kNan; }, "",
                               "must be finite"},
                      BadStart{"InfiniteCovariance", [](auto& m) { m.pose.covariance[35] = kInfF; },
                               "", "covariance of x, y and yaw must be finite"},
                      BadStart{"NegativeVariance", [](auto& m) { m.pose.covariance[7] = -1.0; }, "",
                               "negative eigenvalue"},
                      BadStart{"OutsideTheMap", [](auto& m) { m.pose.pose.position.x = 50.0; }, "",
                               "lies outside the map"},
                      BadStart{"BeyondAllBounds", [](auto& m) { m.pose.pose.position.x = 1e300; },
                               "", "must be finite and within 1e+07 m"},
                      BadStart{"InAnotherFrame", [](auto& m) { m.header.frame_id = "odom"; }, "",
                               "the frame is 'odom'; expected 'map'"},
                      BadStart{"WithoutAFrame", [](auto& m) { m.header.frame_id.clear(); }, "",
                               "the frame is ''; expected 'map'"}),
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
  EXPECT_TRUE(listener_.waitForLog("map rejected"));
  EXPECT_TRUE(listener_.waitForLog(GetParam().words));
  EXPECT_TRUE(listener_.waitForDiagnostic("maps rejected", "1"));
  expectStillLocalizes();
}

TEST_P(LocalizationBadMapTest, LeavesTheNodeWaitingForAnother) {
  parameters_.setParam("global_start", true);
  startNode();
  nav_msgs::OccupancyGrid message = toMessage(testRoom(), "map", ros::Time(1.0));
  GetParam().spoil(message);
  map_.publish(message);
  EXPECT_TRUE(listener_.waitForLog("map rejected"));
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
        BadMap{"WithoutAnOccupiedCell",
               [](auto& m) {
                 for (auto& cell : m.data) cell = 0;
               },
               "", "no occupied cell"},
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
