// Odometry of cars that nobody calibrated.
#include <algorithm>

#include "support/replay_run.h"

namespace racecar_mcl {
namespace {

class CarOdometryTest : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  ReplayedRun drive(const std::vector<std::string>& simulated,
                    const std::vector<std::string>& replayed) {
    std::vector<std::string> simulation{
        "--map", kMap,     "--out", path("drive.bag"), "--truth", path("truth.tum"), "--duration",
        "25",    "--seed", "3",     "--speed",         "3"};
    simulation.insert(simulation.end(), simulated.begin(), simulated.end());
    const ProgramResult result = runProgram(SIMULATE_BAG_PROGRAM, simulation);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<std::string> replay{
        "--bag",           path("drive.bag"),          "--map", kMap, "--truth",
        path("truth.tum"), "--initial-pose-from-truth"};
    replay.insert(replay.end(), replayed.begin(), replayed.end());
    return runReplay(replay);
  }

  /// Odometry from the commanded steering angle: it turns 40 % as far as the car, 0.1 s late.
  ReplayedRun driveBySteeringAngle(std::vector<std::string> simulated,
                                   const std::vector<std::string>& replayed) {
    simulated.insert(simulated.end(), {"--turn-scale-error", "-0.6", "--odom-turn-delay", "0.1"});
    return drive(simulated, replayed);
  }

  const std::string kMap = RACECAR_MCL_SOURCE_DIR "/maps/corridor.yaml";
  TemporaryDirectory folder_;
};

TEST_F(CarOdometryTest, IsCalibratedWithoutAGyro) {
  const ReplayedRun run = driveBySteeringAngle({}, {});
  EXPECT_LE(run.summary["position_error_m"]["mean"], 0.02);
  EXPECT_LE(run.summary["heading_error_deg"]["mean"], 0.8);
  const double turn_scale = std::stod(run.updates.at("turn_scale").back());
  EXPECT_GT(turn_scale, 1.6);
  EXPECT_LT(turn_scale, 2.8);
  EXPECT_EQ(run.summary["gyro"], "no data");
}

TEST_F(CarOdometryTest, IsReplacedByAGyroInDegrees) {
  const ReplayedRun run =
      driveBySteeringAngle({"--imu", "--gyro-in-degrees"}, {"--imu-topic", "/imu"});
  EXPECT_LE(run.summary["position_error_m"]["mean"], 0.02);
  EXPECT_LE(run.summary["heading_error_deg"]["mean"], 0.3);
  EXPECT_EQ(run.summary["gyro"], "used");
  EXPECT_EQ(run.updates.at("turned_by_gyro").back(), "1");
}

TEST_F(CarOdometryTest, IsEnoughForFewScansWithAGyro) {
  const ReplayedRun run =
      driveBySteeringAngle({"--imu", "--scan-dropout", "0.825"}, {"--imu-topic", "/imu"});
  EXPECT_LE(run.summary["position_error_m"]["mean"], 0.04);
  EXPECT_LE(run.summary["heading_error_deg"]["mean"], 0.6);
}

TEST_F(CarOdometryTest, MayBeAFifthTooSlowOrTooFast) {
  for (const double error : {-0.2, 0.2}) {
    const ReplayedRun run = drive({"--speed-scale-error", std::to_string(error)}, {});
    EXPECT_LE(run.summary["position_error_m"]["mean"], 0.02) << error;
    EXPECT_LE(run.summary["position_error_m"]["max"], 0.15) << error;
    EXPECT_NEAR(std::stod(run.updates.at("distance_scale").back()), 1.0 / (1.0 + error), 0.04);
    const auto& states = run.updates.at("status");
    EXPECT_EQ(std::count(states.begin(), states.end(), "localized"), states.size()) << error;
  }
}

}  // namespace
}  // namespace racecar_mcl
