// simulate.launch localize:=true: the car drives a lap and is localized from the start on.
#include <nav_msgs/Odometry.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Int32.h>

#include <algorithm>
#include <set>

#include "racecar_mcl/map/map_io.h"
#include "sim/lap_counter.h"
#include "sim/scenario.h"
#include "sim/simulator.h"
#include "support/localization_listener.h"

namespace racecar_mcl {
namespace {

constexpr double kRealTimeFactor = 2.0;  // as in the .test file
const char* const kMap = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";

/// The true trajectory and the number of collisions.
class TruthListener {
 public:
  explicit TruthListener(ros::NodeHandle node)
      : subscribers_{
            node.subscribe("/ground_truth/odom", 2000, &TruthListener::onTruth, this),
            node.subscribe("/simulator/collisions", 10, &TruthListener::onCollisions, this)} {
    EXPECT_TRUE(sim::loadStartPose(kMap, start_));
    laps_ = sim::LapCounter(start_);
  }
  ~TruthListener() {
    for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
  }

  int laps() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return laps_.laps();
  }
  std::optional<int> collisions() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return collisions_;
  }
  double newest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return poses_.empty() ? 0.0 : poses_.back().stamp;
  }
  std::optional<Pose2> at(double stamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto next =
        std::lower_bound(poses_.begin(), poses_.end(), stamp,
                         [](const sim::Truth& truth, double time) { return truth.stamp < time; });
    if (next == poses_.begin() || next == poses_.end()) return std::nullopt;
    const sim::Truth& before = *std::prev(next);
    return compose(before.base_in_map, integrate(before.twist, stamp - before.stamp));
  }

 private:
  void onTruth(const nav_msgs::Odometry& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const geometry_msgs::Twist& twist = message.twist.twist;
    poses_.push_back({message.header.stamp.toSec(),
                      toPose2(message.pose.pose),
                      {twist.linear.x, twist.linear.y, twist.angular.z}});
    laps_.update(poses_.back().base_in_map);
  }
  void onCollisions(const std_msgs::Int32& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    collisions_ = message.data;
  }

  Pose2 start_;
  mutable std::mutex mutex_;
  std::vector<sim::Truth> poses_;
  sim::LapCounter laps_{Pose2{}};
  std::optional<int> collisions_;
  std::vector<ros::Subscriber> subscribers_;
};

std::set<std::string> parentsOf(const LocalizationListener& listener, const std::string& child) {
  std::set<std::string> parents;
  for (const std::string parent : {"map", "odom", "base_link", "base_link_truth"}) {
    for (const auto& transform : listener.transformsFrom(parent)) {
      if (transform.child_frame_id == child) parents.insert(parent);
    }
  }
  return parents;
}

TEST(SimulatorLapTest, IsDrivenAndLocalizedFasterThanRealTime) {
  ros::AsyncSpinner spinner(1);
  ros::NodeHandle node;
  spinner.start();
  const LocalizationListener listener(node);
  const TruthListener truth(node);
  ASSERT_TRUE(
      listener.waitFor([&] { return !listener.poses().empty() && truth.newest() > 0.0; }, 30.0));
  const double first_stamp = truth.newest();
  const ros::WallTime began = ros::WallTime::now();
  ASSERT_TRUE(listener.waitFor([&] { return truth.laps() > 0; }, 60.0));
  const double simulated = truth.newest() - first_stamp;
  const double factor = simulated / (ros::WallTime::now() - began).toSec();

  std::vector<double> errors;
  for (const nav_msgs::Odometry& pose : listener.poses()) {
    const double stamp = pose.header.stamp.toSec();
    if (stamp < first_stamp + 2.0) continue;  // converges from the announced start pose
    if (const auto base_in_map = truth.at(stamp)) {
      errors.push_back(distance(toPose2(pose.pose.pose), *base_in_map));
    }
  }
  ASSERT_GT(errors.size(), static_cast<std::size_t>(20.0 * (simulated - 3.0))) << "at least 20 Hz";
  std::sort(errors.begin(), errors.end());
  double mean = 0.0;
  for (const double error : errors) mean += error / static_cast<double>(errors.size());
  std::printf("%.1f s at %.2f times real time; position error: mean %.4f m, max %.4f m\n",
              simulated, factor, mean, errors.back());
  EXPECT_LT(mean, 0.04);
  EXPECT_LT(errors.back(), 0.2);
  EXPECT_EQ(truth.collisions(), 0);
  EXPECT_GT(factor, 1.2) << "some lag under load is tolerated";
  EXPECT_LT(factor, 1.1 * kRealTimeFactor);

  using Parents = std::set<std::string>;
  EXPECT_EQ(parentsOf(listener, "base_link"), Parents{"odom"});
  EXPECT_EQ(parentsOf(listener, "odom"), Parents{"map"});
  EXPECT_EQ(parentsOf(listener, "base_link_truth"), Parents{"map"});
}

}  // namespace
}  // namespace racecar_mcl
