// What `replay` says of input that it drops or cannot use.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>

#include "support/replay_fixture.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;
using ReplayErrors = Replay;

TEST_F(ReplayErrors, refusesAStartBeyondTheRecordingOrTheTruth) {
  const std::string bag = record("a.bag");
  expectError(replay({"--bag", bag, "--start", "4"}),
              {"no messages from 4 s on", "duration is 4 s"});
  expectError(replay({"--bag", bag, "--start", "-1"}), {"--start is -1"});
  expectError(replay({"--bag", bag, "--start", "nan"}), {"--start"});
  expectError(replay({"--bag", bag, "--duration", "0"}), {"--duration is 0"});
  expectError(replay({"--bag", bag, "--start", "1.01", "--duration", "0.01"}),
              {"/scan has no scan within --start and --duration"});
  expectError(replay({"--bag", bag, "--start", "2", "--initial-pose-from-truth", "--truth",
                      folder_.write("t.tum", "1500000001 0 0 0 0 0 0 1\n")}),
              {"the truth covers", "after --start (1500000002.000000000 s)"});
}

TEST_F(ReplayErrors, namesAMissingTopicAndWhatTheBagHolds) {
  const std::string bag = record("a.bag");
  expectError(replay({"--bag", bag, "--odom-topic", "/odom"}),
              {bag, "/odom", "--odom-topic", "/vesc/odom (nav_msgs/Odometry)",
               "/scan (sensor_msgs/LaserScan)"});
  expectError(replay({"--bag", bag, "--scan-topic", "/vesc/odom"}),
              {"sensor_msgs/LaserScan", "--scan-topic"});
}

/// The room's bag with every message changed by `change`, which has overloads for both types.
template <typename Change>
std::string changedBag(const std::string& from, const std::string& to, Change&& change) {
  const rosbag::Bag in(from);
  rosbag::Bag out(to, rosbag::bagmode::Write);
  for (const rosbag::MessageInstance& instance : rosbag::View(in)) {
    if (const auto scan = instance.instantiate<sensor_msgs::LaserScan>()) {
      change(*scan);
      out.write(instance.getTopic(), instance.getTime(), *scan);
    } else if (const auto odometry = instance.instantiate<nav_msgs::Odometry>()) {
      if (instance.getTopic() == "/vesc/odom") change(*odometry);
      out.write(instance.getTopic(), instance.getTime(), *odometry);
    } else {
      out.write(instance.getTopic(), instance.getTime(), instance);
    }
  }
  return to;
}

struct NoChange {
  void operator()(sensor_msgs::LaserScan&) const {}
  void operator()(nav_msgs::Odometry&) const {}
};

struct NoOdometryStamp : NoChange {
  using NoChange::operator();
  void operator()(nav_msgs::Odometry& odometry) const { odometry.header.stamp = ros::Time(); }
};

struct BadScans : NoChange {
  using NoChange::operator();
  void operator()(sensor_msgs::LaserScan& scan) const { scan.angle_increment = 0.0f; }
};

struct ScanClockBehind : NoChange {
  using NoChange::operator();
  void operator()(sensor_msgs::LaserScan& scan) const { scan.header.stamp -= ros::Duration(37.0); }
};

struct NoScanFrame : NoChange {
  using NoChange::operator();
  void operator()(sensor_msgs::LaserScan& scan) const { scan.header.frame_id.clear(); }
};

TEST_F(ReplayErrors, saysWhatItDropsAndWhy) {
  const std::string bag = record("a.bag");
  const ProgramResult no_stamps =
      replay({"--bag", changedBag(bag, path("b.bag"), NoOdometryStamp{}), "--initial-pose",
              "0.8 1 0.1", "--truth", folder_.write("t.tum", "1500000000 0.8 1 0 0 0 0.05 1\n")});
  EXPECT_NE(no_stamps.err.find("warning: 201 x odometry dropped: the stamp is zero"),
            std::string::npos)
      << no_stamps.err;
  const ProgramResult behind = replay(
      {"--bag", changedBag(bag, path("c.bag"), ScanClockBehind{}), "--initial-pose", "0.8 1 0.1"});
  EXPECT_NE(behind.err.find("s behind the newest odometry; expected stamps of one clock"),
            std::string::npos)
      << behind.err;
}

TEST_F(ReplayErrors, isAnErrorIfNoScanIsUsed) {
  const ProgramResult result =
      replay({"--bag", changedBag(record("a.bag"), path("b.bag"), BadScans{}), "--initial-pose",
              "0.8 1 0.1"},
             "result");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("41 x scan dropped: the scan's angle_increment is 0"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("error: none of the 41 scans was used"), std::string::npos);
  EXPECT_FALSE(fs::exists(path("result")));
}

TEST_F(ReplayErrors, namesScansWithoutAFrameAndBagsThatAreCutOff) {
  const std::string bag = record("a.bag");
  expectError(replay({"--bag", changedBag(bag, path("b.bag"), NoScanFrame{})}),
              {"the scans on /scan have no frame_id", "--laser-pose"});
  const std::string whole = readWhole(bag);
  expectError(replay({"--bag", folder_.write("cut.bag", whole.substr(0, whole.size() / 2))}),
              {"cut.bag", "cut off", "rosbag reindex"});
}

TEST_F(ReplayErrors, refusesBagsThatCannotBeRead) {
  expectError(replay({"--bag", path("none.bag")}), {"none.bag"});
  expectError(replay({"--bag", map_}), {"room.yaml"});
  const std::string whole = readWhole(record("a.bag"));
  expectError(replay({"--bag", folder_.write("cut.bag", whole.substr(0, whole.size() / 2))}),
              {"cut.bag"});
  std::string broken = whole;
  std::fill(broken.begin() + 6000, broken.begin() + 60000, '\x7f');
  const ProgramResult result = replay({"--bag", folder_.write("broken.bag", broken)});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("replay: error: " + path("broken.bag")), std::string::npos);
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(ReplayErrors, refusesMapsNoCarCanBeOn) {
  const std::string bag = record("a.bag");
  folder_.write("room.pgm", "P5 4 4 255\n" + std::string(16, '\0'));
  expectError(replay({"--bag", bag}), {"no free cell"});
  fs::remove(path("room.pgm"));
  expectError(replay({"--bag", bag}), {"room.pgm"});
  fs::remove(map_);
  expectError(replay({"--bag", bag}), {"room.yaml"});
}

TEST_F(ReplayErrors, refusesParametersAndOptionsThatCannotBe) {
  const std::string bag = record("a.bag");
  const auto refuses = [&](Arguments arguments, const Arguments& words) {
    arguments.insert(arguments.end(), {"--bag", bag});
    expectError(replay(arguments), words);
  };
  refuses({"--set", "num_particels:=3"}, {"num_particels", "num_particles"});
  refuses({"--set", "num_particles:=many"}, {"num_particles", "many"});
  refuses({"--set", "num_particles:=0"}, {"num_particles is 0"});
  refuses({"--set", "num_particles=3"}, {"name:=value"});
  refuses({"--config", path("none.yaml")}, {"none.yaml"});
  refuses({"--motion-from", "wheels"}, {"motion_from", "twist pose tf"});
  refuses({"--motion-from", "tf"},
          {"odom -> base_link", "--odom-frame", "recorded transforms: none"});
  refuses({"--initial-pose", "1 2"}, {"--initial-pose", "x y yaw"});
  refuses({"--initial-pose", "99 2 0"}, {"outside the map"});
  refuses({"--truth", path("none.tum")}, {"none.tum"});
  refuses({"--max-gap", "-1"}, {"--max-gap"});
  refuses({"--global", "--initial-pose", "1 2 0"}, {"--global"});
  refuses({"--particels", "3"}, {"--particels"});
  expectError(replay({}), {"--bag"});
}

TEST_F(ReplayErrors, refusesATruthOfAnotherTime) {
  const std::string bag = record("a.bag");
  expectError(replay({"--bag", bag, "--initial-pose", "0.8 1 0", "--truth",
                      folder_.write("t.tum", "5 0 0 0 0 0 0 1\n")}),
              {"the truth covers"});
  expectError(replay({"--bag", bag, "--initial-pose-from-truth", "--truth",
                      folder_.write("t.tum", "2000000000 0 0 0 0 0 0 1\n")}),
              {"before the localizer is initialized"});
}

}  // namespace
}  // namespace racecar_mcl
