// The programs calibrate_beam_model and calibrate_motion_noise.
#include <gtest/gtest.h>

#include <sstream>

#include "evaluation/trajectory.h"
#include "racecar_mcl/common/random.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "racecar_mcl/sensor/beam_table.h"
#include "support/program.h"
#include "support/room_folder.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

void expectWithinTenPercent(double estimated, double truth) {
  EXPECT_NEAR(estimated, truth, 0.1 * truth);
}

class Calibration : public RoomFolder {
 protected:
  /// The estimated configuration, as read by replay.
  LocalizerParameters configOf(const ProgramResult& result) const {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    LocalizerParameters parameters;
    readParameterFile(folder_.write("printed.yaml", result.out), &parameters);
    validate(parameters);
    return parameters;
  }

  void expectError(const ProgramResult& result, const Arguments& words) const {
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    for (const std::string& word : words) {
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
    }
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(path("out")));
  }

  /// A drive through the room with scans sampled from the beam model, and its trajectory.
  void writeSampledDrive(const BeamTableParameters& truth) const {
    const Eigen::ArrayXXd table = makeBeamTable(truth);
    Random random(1);
    rosbag::Bag bag(path("drive.bag"), rosbag::bagmode::Write);
    Trajectory trajectory;
    for (int tick = 0; tick < 160; ++tick) {
      const double seconds = 0.025 * tick;
      const Pose2 base_in_map = poseInRoom(seconds);
      const Pose2 laser_in_map = compose(base_in_map, laser_in_base_);
      sensor_msgs::LaserScan scan;
      scan.header.stamp = ros::Time(1000.0 + seconds);
      scan.header.frame_id = "laser";
      scan.angle_min = -2.3f;
      scan.angle_increment = 0.01f;
      scan.range_max = 10.0f;
      for (int beam = 0; beam < 461; ++beam) {
        const double bearing = -2.3 + 0.01 * beam;
        const auto d = static_cast<Eigen::Index>(std::lround(
            rangeInRoom(laser_in_map.x, laser_in_map.y, laser_in_map.yaw + bearing) / 0.05));
        double left = random.uniform();
        Eigen::Index z = 0;
        while (z + 1 < table.rows() && (left -= table(z, d)) >= 0.0) ++z;
        scan.ranges.push_back(std::max(0.01f, 0.05f * static_cast<float>(z)));
      }
      bag.write("/scan", scan.header.stamp, scan);
      trajectory.push_back({static_cast<Nanoseconds>(scan.header.stamp.toNSec()), base_in_map});
    }
    std::ostringstream tum;
    writeTum(trajectory, tum);
    folder_.write("drive.tum", tum.str());
  }

  ProgramResult calibrateBeamModel(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--map", map_, "--laser-pose", "0.25 0 0"});
    return runProgram(CALIBRATE_BEAM_MODEL_PROGRAM, arguments);
  }

  /// Runs simulate_bag with these arguments.
  void simulate(Arguments arguments) const {
    arguments.insert(arguments.end(),
                     {"--map", corridor_, "--out", path("sim.bag"), "--truth", path("sim.tum")});
    const ProgramResult result = runProgram(SIMULATE_BAG_PROGRAM, arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  const Pose2 laser_in_base_{0.25, 0.0, 0.0};
  const std::string corridor_ = std::string(RACECAR_MCL_SOURCE_DIR) + "/maps/corridor.yaml";
};

TEST_F(Calibration, SensorModelOfBeamsDrawnFromTheTable) {
  const BeamTableParameters truth{0.62, 0.15, 0.08, 0.15, 3.0, 201};
  writeSampledDrive(truth);
  const ProgramResult result =
      calibrateBeamModel({"--bag", path("drive.bag"), "--trajectory", path("drive.tum"), "--set",
                          "num_beams_per_particle:=461", "--out", path("out")});
  const LocalizerParameters estimated = configOf(result);
  const BeamTableParameters& table = estimated.sensor.beam.table;
  expectWithinTenPercent(table.alpha_hit, truth.alpha_hit);
  expectWithinTenPercent(table.alpha_short, truth.alpha_short);
  expectWithinTenPercent(table.alpha_max, truth.alpha_max);
  expectWithinTenPercent(table.alpha_rand, truth.alpha_rand);
  expectWithinTenPercent(table.sigma_hit, truth.sigma_hit);
  EXPECT_EQ(estimated.sensor.sensor_model, SensorModelType::kBeam);
  EXPECT_EQ(estimated.scan.num_beams_per_particle, 461) << "configured values are kept";
  EXPECT_EQ(readWhole(path("out/beam_model.yaml")), result.out);
  EXPECT_EQ(readWhole(path("out/beam_model.csv")).substr(0, 14), "expected_from,");
}

TEST_F(Calibration, SensorModelOfASimulatedLidar) {
  simulate({"--duration", "20", "--range-noise", "0.25", "--missing-rate", "0.15"});
  const ProgramResult result =
      runProgram(CALIBRATE_BEAM_MODEL_PROGRAM,
                 {"--bag", path("sim.bag"), "--map", corridor_, "--trajectory", path("sim.tum")});
  const BeamTableParameters table = configOf(result).sensor.beam.table;
  expectWithinTenPercent(table.alpha_hit, 0.85);
  expectWithinTenPercent(table.alpha_max, 0.15);
  expectWithinTenPercent(table.sigma_hit, 5.0);
}

TEST_F(Calibration, MotionNoiseOfSimulatedOdometry) {
  simulate({"--duration", "60", "--odom-noise", "0.4", "--speed-scale-error", "0",
            "--turn-scale-error", "0"});
  const ProgramResult result =
      runProgram(CALIBRATE_MOTION_NOISE_PROGRAM,
                 {"--bag", path("sim.bag"), "--trajectory", path("sim.tum"), "--fit",
                  "position_noise_from_time", "yaw_noise_from_time", "--out", path("out")});
  const MotionModelParameters estimated = configOf(result).motion;
  // 0.4 m/s and rad/s over the 0.02 s of a message, 50 messages per second.
  expectWithinTenPercent(estimated.constant_x_sigma, 0.008);
  expectWithinTenPercent(estimated.constant_y_sigma, 0.008);
  expectWithinTenPercent(estimated.constant_yaw_sigma, 0.008);
  expectWithinTenPercent(estimated.position_noise_from_time, 0.008 * std::sqrt(50.0));
  expectWithinTenPercent(estimated.yaw_noise_from_time, 0.008 * std::sqrt(50.0));
  EXPECT_EQ(estimated.longitudinal_noise_from_translation, 0.0);
  EXPECT_EQ(readWhole(path("out/motion_noise.yaml")), result.out);
  EXPECT_EQ(readWhole(path("out/motion_noise.csv")).substr(0, 14), "model,seconds,");
}

TEST_F(Calibration, MotionNoiseOfOdometryFromTfIsThatOfThePosesItHolds) {
  simulate({"--duration", "25", "--odom-noise", "0.4"});
  const auto calibrateFrom = [&](const std::string& what) {
    const ProgramResult result = runProgram(
        CALIBRATE_MOTION_NOISE_PROGRAM,
        {"--bag", path("sim.bag"), "--trajectory", path("sim.tum"), "--motion-from", what});
    return configOf(result).motion;
  };
  const MotionModelParameters from_tf = calibrateFrom("tf"), from_poses = calibrateFrom("pose");
  EXPECT_GT(from_tf.constant_x_sigma, 0.0);
  EXPECT_NEAR(from_tf.constant_x_sigma, from_poses.constant_x_sigma, 1e-5);
  EXPECT_NEAR(from_tf.constant_yaw_sigma, from_poses.constant_yaw_sigma, 1e-5);
}

TEST_F(Calibration, BadInputIsOneLineOfErrorAndLeavesNothing) {
  writeSampledDrive({});
  const std::string bag = path("drive.bag");
  const std::string other_time =
      folder_.write("late.tum", "5000 0 0 0 0 0 0 1\n5001 0 0 0 0 0 0 1\n");
  expectError(calibrateBeamModel({"--bag", path("none.bag"), "--trajectory", path("drive.tum"),
                                  "--out", path("out")}),
              {"none.bag"});
  expectError(
      calibrateBeamModel({"--bag", bag, "--trajectory", path("none.tum"), "--out", path("out")}),
      {"none.tum"});
  expectError(calibrateBeamModel({"--bag", bag, "--trajectory", other_time, "--out", path("out")}),
              {"late.tum", "5000.0", "1000.0", "0 of 160 scans"});
  expectError(calibrateBeamModel({"--bag", bag, "--trajectory", path("drive.tum"), "--set",
                                  "alpha_hit:=2", "--out", path("out")}),
              {"alpha_hit"});
  expectError(runProgram(CALIBRATE_MOTION_NOISE_PROGRAM,
                         {"--bag", bag, "--trajectory", path("drive.tum"), "--out", path("out")}),
              {"/vesc/odom", "--odom-topic"});

  writeRoomBag(path("room.bag"), {});
  const Arguments motion{"--bag", path("room.bag"), "--out", path("out"), "--trajectory"};
  const auto calibrateMotionNoise = [&](const Arguments& more) {
    Arguments arguments = motion;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runProgram(CALIBRATE_MOTION_NOISE_PROGRAM, arguments);
  };
  expectError(calibrateMotionNoise({other_time}), {"late.tum", "0 motions", "at least"});
  expectError(calibrateMotionNoise({other_time, "--interval", "0"}), {"--interval"});
}

}  // namespace
}  // namespace racecar_mcl
