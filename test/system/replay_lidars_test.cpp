// Recordings of a car with two lidars.
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>

#include <functional>

#include "support/replay_run.h"

namespace racecar_mcl {
namespace {

class ReplayLidars : public ::testing::Test {
 protected:
  void SetUp() override {
    const ProgramResult result =
        runProgram(SIMULATE_BAG_PROGRAM,
                   {"--map", kMap, "--out", path("drive.bag"), "--duration", "12", "--seed", "5",
                    "--rear-lidar", "--rear-range-bias", "0.03", "--rear-clockwise"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  /// Copies the bag; `change` returns the topic of a scan, whose frame it may change.
  void rewrite(const std::string& name,
               const std::function<std::string(sensor_msgs::LaserScan*)>& change) const {
    rosbag::Bag in(path("drive.bag"));
    rosbag::Bag out(path(name), rosbag::bagmode::Write);
    for (const rosbag::MessageInstance& instance : rosbag::View(in)) {
      if (const auto scan = instance.instantiate<sensor_msgs::LaserScan>()) {
        const std::string topic = change(scan.get());
        out.write(topic, instance.getTime(), *scan);
      } else {
        out.write(instance.getTopic(), instance.getTime(), instance);
      }
    }
  }

  std::vector<std::string> arguments(const std::string& bag) const {
    return {"--bag", path(bag), "--map", kMap, "--initial-pose-from-truth"};
  }

  ReplayedRun replay(const std::string& bag, const std::vector<std::string>& topics) const {
    std::vector<std::string> all = arguments(bag);
    all.emplace_back("--scan-topic");
    all.insert(all.end(), topics.begin(), topics.end());
    return runReplay(all);
  }

  const std::string kMap = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
  TemporaryDirectory folder_;
};

TEST_F(ReplayLidars, CalibratesEachLidarOfTwoTopics) {
  const ReplayedRun run = replay("drive.bag", {"/scan", "/scan_rear"});
  EXPECT_LT(run.summary.at("position_error_m").at("mean"), 0.03);
  const nlohmann::json& lidars = run.summary.at("lidars");
  ASSERT_EQ(lidars.size(), 2u);
  EXPECT_EQ(lidars[0].at("frame"), "laser");
  EXPECT_EQ(lidars[1].at("frame"), "laser_rear");
  EXPECT_EQ(lidars[1].at("topic"), "/scan_rear");
  EXPECT_GT(lidars[1].at("scans_used"), 450);
  EXPECT_EQ(lidars[0].at("scan_direction"), "listed");
  EXPECT_EQ(lidars[1].at("scan_direction"), "reversed");
  EXPECT_NEAR(
      lidars[1].at("range_bias_m").get<double>() - lidars[0].at("range_bias_m").get<double>(), 0.03,
      0.01);
  const std::vector<std::string> indices = run.updates.at("lidar");
  EXPECT_EQ(std::count(indices.begin(), indices.end(), "0") +
                std::count(indices.begin(), indices.end(), "1"),
            static_cast<std::ptrdiff_t>(indices.size()));
}

TEST_F(ReplayLidars, FramesDistinguishThemOnOneTopic) {
  rewrite("one.bag", [](sensor_msgs::LaserScan* /*scan*/) { return "/scan"; });
  const ReplayedRun one = replay("one.bag", {"/scan"});
  const ReplayedRun two = replay("drive.bag", {"/scan /scan_rear"});
  ASSERT_EQ(one.estimate.size(), two.estimate.size());
  for (std::size_t i = 0; i < one.estimate.size(); ++i) {
    ASSERT_EQ(one.estimate[i].stamp, two.estimate[i].stamp);
    ASSERT_EQ(one.estimate[i].pose.x, two.estimate[i].pose.x);
  }
  EXPECT_EQ(one.summary.at("lidars")[1].at("range_bias_m"),
            two.summary.at("lidars")[1].at("range_bias_m"));
}

TEST_F(ReplayLidars, OneFrameOnTwoTopicsIsRefusedByName) {
  rewrite("same.bag", [](sensor_msgs::LaserScan* scan) {
    const std::string topic = scan->header.frame_id == "laser" ? "/scan" : "/scan_rear";
    scan->header.frame_id = "laser";
    return topic;
  });
  std::vector<std::string> all = arguments("same.bag");
  all.insert(all.end(), {"--scan-topic", "/scan", "/scan_rear", "--out", path("out")});
  const ProgramResult result = runProgram(REPLAY_PROGRAM, all);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("scans on /scan and on /scan_rear have the frame 'laser'; expected a "
                            "frame of its own for each lidar"),
            std::string::npos)
      << result.err;
}

TEST_F(ReplayLidars, ScansOfAnUnknownFrameAreDroppedByName) {
  int count = 0;
  rewrite("odd.bag", [&](sensor_msgs::LaserScan* scan) {
    const std::string topic = scan->header.frame_id == "laser" ? "/scan" : "/scan_rear";
    if (topic == "/scan" && ++count > 100) scan->header.frame_id = "nowhere";
    return topic;
  });
  std::vector<std::string> all = arguments("odd.bag");
  all.insert(all.end(), {"--out", path("out")});
  const ProgramResult result = runProgram(REPLAY_PROGRAM, all);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("to the lidar's frame 'nowhere'"), std::string::npos) << result.err;
  all.insert(all.end(), {"--laser-pose", "0.27 0 0"});
  EXPECT_NE(runProgram(REPLAY_PROGRAM, all).err.find("--laser-pose is the pose of one lidar"),
            std::string::npos);
}

}  // namespace
}  // namespace racecar_mcl
