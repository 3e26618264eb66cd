// Simulated time: looping bags and paused clocks.
#include <rosgraph_msgs/Clock.h>

#include "support/localization_fixture.h"

namespace racecar_mcl {
namespace {

class LocalizationTimeTest : public LocalizationTest {
 protected:
  LocalizationTimeTest() : clock_(handle_.advertise<rosgraph_msgs::Clock>("/clock", 10)) {
    car_.setStamp(kBegin);
    publishClock();
  }

  void onTick() override { publishClock(); }

  void publishClock() {
    rosgraph_msgs::Clock clock;
    clock.clock = ros::Time(car_.stamp());
    clock_.publish(clock);
  }

  static constexpr double kBegin = 100.0;  // s
  ros::Publisher clock_;
};

TEST_F(LocalizationTimeTest, StartsABagThatLoopsAtInitialPoseAgain) {
  const Pose2 start = car_.baseInMap();
  parameters_.setParam("initial_pose", std::vector<double>{start.x, start.y, start.yaw});
  parameters_.setParam("expert/initial_sigma", 0.1);
  startNode();
  publishMap();
  ASSERT_TRUE(listener_.waitForLog("map of"));
  for (int loop = 1; loop <= 3; ++loop) {
    drive(2.2);  // not a full circle: the bag ends at another pose
    expectLocalized();
    car_.place(start);
    car_.setStamp(kBegin);
    EXPECT_GT(drive(0.5), 9);
    expectLocalized();
    EXPECT_LT(listener_.poses().back().header.stamp.toSec(), kBegin + 0.6);
    EXPECT_TRUE(listener_.waitForDiagnostic("time jumps", std::to_string(loop)));
    EXPECT_EQ(listener_.logged("(bag loop): odometry was reset; starting at initial_pose"), loop);
  }
}

TEST_F(LocalizationTimeTest, KeepsThePoseOverALoopThatEndsWhereItBegan) {
  startLocalized();
  for (int loop = 0; loop < 3; ++loop) {
    drive(2.0);
    expectLocalized();
    car_.setStamp(kBegin);
  }
  drive(1.0);
  expectLocalized();
  EXPECT_TRUE(listener_.waitForDiagnostic("time jumps", "3"));
}

TEST_F(LocalizationTimeTest, TakesAScanBeforeOdometryAfterALoop) {
  startLocalized();
  drive(3.0);
  car_.setStamp(kBegin);
  publishClock();
  EXPECT_FALSE(sendScan(car_.scan(), 0.1)) << "one scan is no jump of the clock";
  car_.advance(0.025);
  publishClock();
  sendScan(car_.scan(), 0.1);
  EXPECT_TRUE(listener_.waitForDiagnostic("time jumps", "1"));
  expectStillLocalizes();
  EXPECT_TRUE(listener_.waitForDiagnostic("time jumps", "1"));
}

TEST_F(LocalizationTimeTest, LocalizesOnWhileTheClockStandsStill) {
  startLocalized();
  const rosgraph_msgs::Clock stopped;
  for (int i = 0; i < 20; ++i) {
    car_.advance(0.04);
    clock_.publish(stopped);
    odometry_.publish(car_.odometry());
    EXPECT_TRUE(sendScan(car_.scan()));
  }
  expectLocalized();
  sensor_msgs::LaserScan empty = car_.scan();
  empty.ranges.clear();
  scans_.publish(empty);
  EXPECT_TRUE(listener_.waitForLog("the scan is empty")) << "also at time 0";
}

TEST_F(LocalizationTimeTest, LocalizesOnWhileTheClockLagsByManySimulatedSeconds) {
  startLocalized();
  drive(1.0);
  // At 8 times real time, a second of a busy processor is 8 s; the clock's messages come late.
  rosgraph_msgs::Clock late;
  late.clock = ros::Time(car_.stamp() - 30.0);
  for (int i = 0; i < 20; ++i) {
    car_.advance(0.04);
    clock_.publish(late);
    odometry_.publish(car_.odometry());
    EXPECT_TRUE(sendScan(car_.scan()));
  }
  expectLocalized();
  EXPECT_EQ(listener_.diagnostic("stamps rejected"), "0");
  sensor_msgs::LaserScan wall_time = car_.scan();
  wall_time.header.stamp = ros::Time(ros::WallTime::now().toSec());
  scans_.publish(wall_time);
  EXPECT_TRUE(listener_.waitForLog("more than 1000 s ahead of the clock"));
}

TEST_F(LocalizationTimeTest, TakesAPausedBagForNoSilence) {
  parameters_.setParam("input_timeout", 0.4);
  startLocalized();
  drive(1.0);
  // The silence begins at the clock's time when the last scan is processed.
  car_.advance(0.04);
  publishClock();
  ASSERT_TRUE(listener_.waitFor([&] { return ros::Time::now().toSec() > car_.stamp() - 1e-6; }));
  odometry_.publish(car_.odometry());
  ASSERT_TRUE(sendScan(car_.scan()));
  ASSERT_TRUE(listener_.waitForDiagnostic("status", "localized"));
  ros::WallDuration(1.0).sleep();
  EXPECT_EQ(listener_.diagnostic("status"), "localized") << "the clock is paused";
  car_.setStamp(car_.stamp() + 0.5);
  publishClock();
  EXPECT_TRUE(listener_.waitForDiagnostic("status", "degraded"));
  EXPECT_EQ(listener_.diagnostic("reason"), "no usable scan for 0.5 s");
}

}  // namespace
}  // namespace racecar_mcl
