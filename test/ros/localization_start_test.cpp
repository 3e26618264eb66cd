// Start poses, and the state before one is set.
#include <geometry_msgs/PoseArray.h>
#include <nav_msgs/SetMap.h>
#include <std_srvs/Empty.h>

#include <cstdlib>

#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

/// Mean and standard deviations of the published particles.
struct Cloud {
  double x = 0.0, y = 0.0, sigma_x = 0.0, sigma_y = 0.0;
  std::size_t size = 0;
};

class LocalizationStartTest : public LocalizationTest {
 protected:
  void listenToParticles() {
    particles_ = handle_.subscribe<geometry_msgs::PoseArray>(
        "pf/viz/particles", 1, [this](const geometry_msgs::PoseArrayConstPtr& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          cloud_ = {};
          const double n = static_cast<double>(message->poses.size());
          cloud_.size = message->poses.size();
          for (const auto& pose : message->poses) {
            cloud_.x += pose.position.x / n;
            cloud_.y += pose.position.y / n;
          }
          for (const auto& pose : message->poses) {
            cloud_.sigma_x += std::pow(pose.position.x - cloud_.x, 2) / n;
            cloud_.sigma_y += std::pow(pose.position.y - cloud_.y, 2) / n;
          }
          cloud_.sigma_x = std::sqrt(cloud_.sigma_x);
          cloud_.sigma_y = std::sqrt(cloud_.sigma_y);
        });
    ASSERT_TRUE(listener_.waitFor([&] { return particles_.getNumPublishers() > 0; }));
  }
  Cloud cloud() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return cloud_;
  }

  std::mutex mutex_;
  Cloud cloud_;
  ros::Subscriber particles_;
};

TEST_F(LocalizationStartTest, SaysOnceThatItWaitsForAMapAndThenForAStartPose) {
  startNode();
  // Not in the first seconds, in which a map and a start pose may still arrive.
  const auto send_unused_scans = [this](const std::string& words) {
    for (int i = 0; i < 5; ++i) {
      if (i == 3) {
        EXPECT_EQ(listener_.logged(words), 0);
        ros::WallDuration(2.1).sleep();
      }
      car_.advance(0.02);
      odometry_.publish(car_.odometry());
      EXPECT_FALSE(sendScan(car_.scan(), 0.05));
    }
  };
  send_unused_scans("waiting for a map");
  EXPECT_TRUE(listener_.waitForLog("waiting for a map on " + namespace_ + "/map"));
  EXPECT_EQ(listener_.logged("waiting for a map"), 1);
  EXPECT_EQ(listener_.diagnostics().message, "waiting for a map");

  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of 162 x 122 cells"));
  send_unused_scans("waiting for a start pose");
  EXPECT_TRUE(listener_.waitForLog("waiting for a start pose"));
  EXPECT_EQ(listener_.logged("waiting for a start pose"), 1);
  // On a slow machine a scan may be superseded before it is dropped.
  EXPECT_TRUE(listener_.waitFor([&] {
    return std::atoi(listener_.diagnostic("scans dropped").c_str()) +
               std::atoi(listener_.diagnostic("scans superseded").c_str()) ==
           10;
  }));
  EXPECT_TRUE(listener_.waitForDiagnostic("odometry seen", "10"));
  EXPECT_EQ(listener_.diagnostics().message, "waiting for a start pose");
  EXPECT_TRUE(listener_.poses().empty());
  EXPECT_TRUE(listener_.transformsFrom("map").empty());

  initial_pose_.publish(startMessage(car_.baseInMap()));
  ASSERT_TRUE(listener_.waitForLog("localizing from"));
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, FromInitialPose) {
  startLocalized();
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitFor(
      [&] { return listener_.diagnostics().message.rfind("localized", 0) == 0; }));
}

TEST_F(LocalizationStartTest, HonoursTheCovarianceOfInitialPose) {
  parameters_.setParam("num_particles", 4000);
  parameters_.setParam("expert/resample_threshold", 0.0);
  parameters_.setParam("expert/min_effective_particles", 0);
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  listenToParticles();
  auto start = startMessage(car_.baseInMap());
  start.pose.covariance[0] = 0.3 * 0.3;
  start.pose.covariance[7] = 0.05 * 0.05;
  initial_pose_.publish(start);
  ASSERT_TRUE(listener_.waitForLog("localizing from"));
  ASSERT_TRUE(sendScan(car_.scan()));
  ASSERT_TRUE(listener_.waitFor([&] { return cloud().size > 0; }));
  EXPECT_EQ(cloud().size, 4000U);
  EXPECT_NEAR(cloud().x, car_.baseInMap().x, 0.03);
  EXPECT_NEAR(cloud().sigma_x, 0.3, 0.02);
  EXPECT_NEAR(cloud().sigma_y, 0.05, 0.005);
}

TEST_F(LocalizationStartTest, TakesTheParametersSpreadWhereInitialPoseBringsNone) {
  parameters_.setParam("num_particles", 4000);
  parameters_.setParam("expert/resample_threshold", 0.0);
  parameters_.setParam("expert/min_effective_particles", 0);
  parameters_.setParam("expert/initial_sigma", 0.4);
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  listenToParticles();
  initial_pose_.publish(startMessage(car_.baseInMap(), 0.0));
  ASSERT_TRUE(listener_.waitForLog("localizing from"));
  ASSERT_TRUE(sendScan(car_.scan()));
  ASSERT_TRUE(listener_.waitFor([&] { return cloud().size > 0; }));
  EXPECT_NEAR(cloud().sigma_x, 0.4, 0.03);
  EXPECT_NEAR(cloud().sigma_y, 0.4, 0.03);
}

TEST_F(LocalizationStartTest, AnotherInitialPoseMovesTheParticlesThere) {
  startLocalized();
  expectStillLocalizes();
  const Pose2 elsewhere = compose(roomInMap(), {2.0, 2.5, 1.0});
  car_.place(elsewhere);
  initial_pose_.publish(startMessage(elsewhere));
  ASSERT_TRUE(listener_.waitFor([&] { return listener_.logged("localizing from") == 2; }));
  car_.twist = {0.5, 0.0, 1.0};
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, AnInitialPoseAppliesAtItsStamp) {
  startLocalized();
  expectStillLocalizes();
  geometry_msgs::PoseWithCovarianceStamped start = startMessage(car_.baseInMap(), 0.05);
  start.header.stamp = ros::Time(car_.stamp());
  for (int i = 0; i < 50; ++i) {  // without scans
    car_.advance(0.02);
    odometry_.publish(car_.odometry());
  }
  const int starts = listener_.logged("localizing from");
  ros::WallDuration(0.2).sleep();
  initial_pose_.publish(start);
  ASSERT_TRUE(listener_.waitFor([&] { return listener_.logged("localizing from") > starts; }));
  car_.advance(0.02);
  odometry_.publish(car_.odometry());
  expectLocalized();
}

TEST_F(LocalizationStartTest, FromTheParameter) {
  const Pose2 start = car_.baseInMap();
  parameters_.setParam("initial_pose", std::to_string(start.x) + " " + std::to_string(start.y) +
                                           " " + std::to_string(start.yaw));
  parameters_.setParam("expert/initial_sigma", 0.1);
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, FromAListAsTheParameter) {
  const Pose2 start = car_.baseInMap();
  parameters_.setParam("initial_pose", std::vector<double>{start.x, start.y, start.yaw});
  parameters_.setParam("expert/initial_sigma", 0.1);
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, GloballyByParameterAsSoonAsThereIsAMap) {
  parameters_.setParam("global_start", true);
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("localizing globally"));
  drive(3.0);
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, GloballyByClickedPoint) {
  ros::Publisher clicked = handle_.advertise<geometry_msgs::PointStamped>("clicked_point", 1);
  startNode();
  clicked.publish(geometry_msgs::PointStamped());
  ASSERT_TRUE(listener_.waitForLog("global localization rejected: it requires a map"));
  EXPECT_TRUE(listener_.waitForDiagnostic("start poses rejected", "1"));
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  clicked.publish(geometry_msgs::PointStamped());
  ASSERT_TRUE(listener_.waitForLog("localizing globally"));
  drive(3.0);
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, GloballyByService) {
  startLocalized();
  car_.place(compose(roomInMap(), {4.5, 4.5, 3.0}));  // kidnapped
  car_.twist = {0.8, 0.0, 1.0};
  std_srvs::Empty empty;
  ASSERT_TRUE(ros::service::call(namespace_ + "/global_localization", empty));
  ASSERT_TRUE(listener_.waitForLog("localizing globally"));
  drive(3.0);
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, SetMapBringsMapAndPoseAtOnce) {
  startNode();
  nav_msgs::SetMap set_map;
  set_map.request.map = toMessage(testRoom(), "map", ros::Time(1.0));
  set_map.request.initial_pose = startMessage(car_.baseInMap());
  ASSERT_TRUE(ros::service::call(namespace_ + "/set_map", set_map));
  EXPECT_TRUE(set_map.response.success);
  ASSERT_TRUE(listener_.waitForLog("localizing from"));
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, SetMapRefusesWhatCannotBeUsed) {
  startLocalized();
  nav_msgs::SetMap no_orientation;
  no_orientation.request.map = toMessage(testRoom(), "map", ros::Time(1.0));
  ASSERT_TRUE(ros::service::call(namespace_ + "/set_map", no_orientation));
  EXPECT_FALSE(no_orientation.response.success);
  EXPECT_TRUE(listener_.waitForLog("set_map rejected: the quaternion"));
  ros::WallDuration(1.1).sleep();  // another reason is logged after a second

  nav_msgs::SetMap outside = no_orientation;
  outside.request.initial_pose = startMessage({100.0, 100.0, 0.0});
  ASSERT_TRUE(ros::service::call(namespace_ + "/set_map", outside));
  EXPECT_FALSE(outside.response.success);
  EXPECT_TRUE(listener_.waitForLog("set_map rejected: the initial pose lies outside the map"));
  ros::WallDuration(1.1).sleep();

  nav_msgs::SetMap walls_only = no_orientation;
  walls_only.request.initial_pose = startMessage(car_.baseInMap());
  for (auto& cell : walls_only.request.map.data) cell = 100;
  ASSERT_TRUE(ros::service::call(namespace_ + "/set_map", walls_only));
  EXPECT_FALSE(walls_only.response.success);
  EXPECT_TRUE(listener_.waitForLog("set_map rejected: the map has no free cell"));
  EXPECT_TRUE(listener_.waitForDiagnostic("maps rejected", "3"));
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, AnotherMapWhileRunningKeepsThePose) {
  startLocalized();
  expectStillLocalizes();
  const std::size_t starts = static_cast<std::size_t>(listener_.logged("localizing from"));
  publishMap(testRoom(0.1));
  ASSERT_TRUE(listener_.waitForLog("map of 82 x 62 cells at 0.1 m"));
  expectStillLocalizes();
  EXPECT_EQ(static_cast<std::size_t>(listener_.logged("localizing from")), starts);
}

TEST_F(LocalizationStartTest, SaysWhatItsMapIsAndWarnsOnce) {
  startNode();
  publishMap(testRoom(0.2));
  ASSERT_TRUE(listener_.waitForLog(
      "map of 42 x 32 cells at 0.2 m, 8.4 x 6.4 m: filled map (solid outside)"));
  EXPECT_TRUE(listener_.waitForLog("map: cells of 0.2 m are coarse"));
  publishMap(testRoom(0.2));
  ASSERT_TRUE(listener_.waitFor([&] { return listener_.logged("map of 42 x 32 cells") == 2; }));
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of 162 x 122 cells"));
  EXPECT_EQ(listener_.logged("are coarse"), 1);
  EXPECT_EQ(listener_.logged("map: "), 1);
}

TEST_F(LocalizationStartTest, SaysWhenANewMapDoesNotHoldThePose) {
  startLocalized();
  const OccupancyGrid room = testRoom();
  GridGeometry far = room.geometry();
  far.origin = {500.0, 0.0, 0.0};
  publishMap(OccupancyGrid(far, room.cells()));
  EXPECT_TRUE(listener_.waitForLog("lies outside the new map"));
  publishMap();
  ASSERT_TRUE(listener_.waitFor([&] { return listener_.logged("map of 162") == 3; }));
  expectStillLocalizes();
}

TEST_F(LocalizationStartTest, StopsWeighingWhileParkedUntilAskedTo) {
  parameters_.setParam("expert/stationary_updates", 5);
  startLocalized();
  expectStillLocalizes();
  car_.twist = {};
  drive(1.5);  // a car that stops at once is held to slip for some scans
  ASSERT_TRUE(listener_.waitFor(
      [&] { return std::atoi(listener_.diagnostic("scans stationary").c_str()) > 19; }));
  const std::string used = listener_.diagnostic("scans used");
  EXPECT_GT(drive(0.2), 0) << "the pose is also published while stationary";
  EXPECT_EQ(listener_.diagnostic("scans used"), used);
  std_srvs::Empty empty;
  ASSERT_TRUE(ros::service::call(namespace_ + "/request_nomotion_update", empty));
  drive(0.2);
  EXPECT_TRUE(listener_.waitFor([&] { return listener_.diagnostic("scans used") != used; }));
  expectLocalized();
}

}  // namespace
}  // namespace racecar_mcl
