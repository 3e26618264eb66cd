// The simulated corridor with the course report's constants (its section 3.1): the error is at
// least 10 % lower, and the covariance is consistent.
#include "support/replay_run.h"

namespace racecar_mcl {
namespace {

constexpr double kDriveSeconds = 25.0;

class CorridorAccuracyTest : public ::testing::TestWithParam<std::string> {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  void simulate() {
    const ProgramResult result = runProgram(
        SIMULATE_BAG_PROGRAM,
        {"--map", kMap, "--out", path("drive.bag"), "--truth", path("truth.tum"), "--duration",
         std::to_string(kDriveSeconds), "--speed", "3", "--seed", "5", "--odom-noise", GetParam(),
         "--speed-scale-error", "0", "--turn-scale-error", "0"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    truth_ = readTum(path("truth.tum"));
  }

  /// Started with an error of 20 cm.
  ReplayedRun replay(const std::string& config) const {
    const Pose2 start = truth_.front().pose;
    std::ostringstream pose;
    pose << start.x + 0.14 << " " << start.y + 0.14 << " " << start.yaw;
    return runReplay({"--bag", path("drive.bag"), "--map", kMap, "--truth", path("truth.tum"),
                      "--config", std::string(RACECAR_MCL_SOURCE_DIR "/config/") + config,
                      "--initial-pose", pose.str(), "--seed", "1"});
  }

  /// The fraction of updates after the first second with an error within 3 sigma on an axis.
  double shareWithin3Sigma(const ReplayedRun& run, const std::string& axis,
                           double Pose2::*component) const {
    const auto column = [&](const std::string& name) { return run.updates.at(name); };
    const std::vector<std::string> stamps = column("stamp");
    int inside = 0, all = 0;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const double stamp = std::stod(stamps[i]);
      const auto nanoseconds = static_cast<Nanoseconds>(std::llround(stamp * 1e9));
      if (nanoseconds < truth_.front().stamp + 1000000000) continue;
      const std::optional<Pose2> truth = poseAt(truth_, nanoseconds, 0.1);
      if (!truth) continue;
      const double error = std::stod(column(axis)[i]) - (*truth).*component;
      const double sigma = std::sqrt(std::stod(column("cov_" + axis + axis)[i]));
      inside += std::abs(axis == "yaw" ? wrapAngle(error) : error) <= 3.0 * sigma;
      ++all;
    }
    return static_cast<double>(inside) / all;
  }

  const std::string kMap = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
  TemporaryDirectory folder_;
  Trajectory truth_;
};

TEST_P(CorridorAccuracyTest, ReportsConstants) {
  simulate();
  const ReplayedRun run = replay("report.yaml");
  ASSERT_FALSE(run.estimate.empty());
  EXPECT_LE(run.summary["position_error_m"]["mean"], 0.03);
  EXPECT_LE(run.summary["position_error_m"]["max"], 0.25) << "never lost";
  EXPECT_GT(run.summary["scans_used"], 39.0 * kDriveSeconds);
  EXPECT_GE(shareWithin3Sigma(run, "x", &Pose2::x), 0.98);
  EXPECT_GE(shareWithin3Sigma(run, "y", &Pose2::y), 0.98);
  EXPECT_GE(shareWithin3Sigma(run, "yaw", &Pose2::yaw), 0.98);
}

TEST_P(CorridorAccuracyTest, OwnDefaults) {
  simulate();
  const ReplayedRun run = replay("default.yaml");
  ASSERT_FALSE(run.estimate.empty());
  EXPECT_LE(run.summary["position_error_m"]["mean"], 0.02);
  EXPECT_LE(run.summary["position_error_m"]["max"], 0.25);
  EXPECT_GE(shareWithin3Sigma(run, "x", &Pose2::x), 0.97);
  EXPECT_GE(shareWithin3Sigma(run, "y", &Pose2::y), 0.97);
  EXPECT_GE(shareWithin3Sigma(run, "yaw", &Pose2::yaw), 0.97);
}

INSTANTIATE_TEST_SUITE_P(OdometryNoise, CorridorAccuracyTest, ::testing::Values("0", "0.05", "0.1"),
                         [](const auto& noise) {
                           std::string name = noise.param;
                           for (char& letter : name) letter = letter == '.' ? '_' : letter;
                           return name;
                         });

}  // namespace
}  // namespace racecar_mcl
