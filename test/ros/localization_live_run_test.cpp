// Compares a bag played live through localize.launch with its offline replay.
#include "support/localization_listener.h"
#include "support/process.h"
#include "support/replay_run.h"

namespace racecar_mcl {
namespace {

const char* const kMap = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";

TEST(LocalizationLiveRunTest, AgreesWithReplayAndWithTheTruth) {
  const TemporaryDirectory folder;
  const std::string bag = (folder.path() / "drive.bag").string();
  const std::string truth_file = (folder.path() / "truth.tum").string();
  const ProgramResult simulated = runProgram(
      SIMULATE_BAG_PROGRAM, {"--map", kMap, "--out", bag, "--truth", truth_file, "--duration", "20",
                             "--speed", "3", "--seed", "7", "--odom-noise", "0.1"});
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  const Trajectory truth = readTum(truth_file);
  std::string start;
  ASSERT_TRUE(ros::param::get("/live_run/initial_pose", start));
  const ReplayedRun replayed =
      runReplay({"--bag", bag, "--map", kMap, "--truth", truth_file, "--config",
                 RACECAR_MCL_SOURCE_DIR "/config/default.yaml", "--initial-pose", start});
  ASSERT_FALSE(replayed.estimate.empty());

  ros::AsyncSpinner spinner(1);
  spinner.start();
  ros::NodeHandle node;
  const LocalizationListener listener(node);
  ASSERT_TRUE(listener.waitFor(
      [&] {
        const std::string state = listener.diagnostics().message;
        return !state.empty() && state != "waiting for a map";
      },
      20.0));
  Process player({"rosbag", "play", "--clock", "--quiet", "--delay", "1", bag});
  ASSERT_EQ(player.wait(60.0), 0);
  ASSERT_TRUE(listener.waitFor([&] {
    const auto newest = listener.newestPose();
    return newest && newest->header.stamp.toSec() > toSeconds(truth.back().stamp) - 0.1;
  }));

  std::vector<double> from_replay, from_truth;
  for (const nav_msgs::Odometry& live : listener.poses()) {
    const auto stamp = static_cast<Nanoseconds>(live.header.stamp.toNSec());
    if (stamp < truth.front().stamp + 2000000000)
      continue;  // both converge from an initial error of 14 cm
    const Pose2 pose = toPose2(live.pose.pose);
    if (const auto other = poseAt(replayed.estimate, stamp, 0.1)) {
      from_replay.push_back(distance(pose, *other));
    }
    if (const auto true_pose = poseAt(truth, stamp, 0.1)) {
      from_truth.push_back(distance(pose, *true_pose));
    }
  }
  std::printf("live poses %zu, from replay %.4f m, from truth %.4f m, replay's own %.4f m\n",
              from_truth.size(), mean(from_replay), mean(from_truth),
              replayed.summary["position_error_m"]["mean"].get<double>());
  EXPECT_GT(from_truth.size(), 18U * 20U) << "at least 20 Hz";
  EXPECT_LT(mean(from_replay), 0.02);
  EXPECT_LT(mean(from_truth), 0.05);
  EXPECT_LT(quantile(from_truth, 1.0), 0.5);
}

}  // namespace
}  // namespace racecar_mcl
