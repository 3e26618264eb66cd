#include "ros/localization/pose_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/program.h"
#include "support/temporary_directory.h"

namespace racecar_mcl {
namespace {

SavedPose savedPose() {
  SavedPose pose{"one map", {1.0, 2.0, 0.5}, OdometryPose{100.0, {10.0, 0.0, 0.0}}, {}};
  pose.sensors = SensorCalibration{{0.98, 0.01, {1.2, -0.02, 0.1}, 60.0},
                                   {{0.03, true}, {0.2, false}, {-0.01, false}}};
  pose.lidar_frames = {"laser", "", "rear \"laser\": {1}"};
  return pose;
}

TEST(PoseFile, ReturnsWhatWasWritten) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "pose.yaml").string();
  EXPECT_FALSE(readPoseFile(path));
  writePoseFile(path, savedPose());
  writePoseFile(path, savedPose());
  const std::optional<SavedPose> read = readPoseFile(path);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->map, "one map");
  EXPECT_EQ(read->base_in_map.yaw, 0.5);
  ASSERT_TRUE(read->odometry);
  EXPECT_EQ(read->odometry->stamp, 100.0);
  EXPECT_EQ(read->odometry->base_in_odom.x, 10.0);
  ASSERT_TRUE(read->sensors);
  EXPECT_EQ(read->sensors->odometry.distance_scale, 0.98);
  EXPECT_EQ(read->sensors->odometry.scale_distance, 60.0);
  EXPECT_EQ(read->sensors->odometry.delay, 0.01);
  EXPECT_EQ(read->sensors->odometry.turn.scale, 1.2);
  EXPECT_EQ(read->sensors->odometry.turn.offset, -0.02);
  EXPECT_EQ(read->sensors->odometry.turn.delay, 0.1);
  EXPECT_EQ(read->lidar_frames, (std::vector<std::string>{"laser", "rear \"laser\": {1}"}));
  ASSERT_EQ(read->sensors->lidars.size(), 2U);
  EXPECT_EQ(read->sensors->lidars[0].range_bias, 0.03);
  EXPECT_TRUE(read->sensors->lidars[0].scan_reversed);
  EXPECT_EQ(read->sensors->lidars[1].range_bias, -0.01);
  EXPECT_FALSE(read->sensors->lidars[1].scan_reversed);
  // Nothing but the file is left.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(PoseFile, NamesTheFileThatIsWrong) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "pose.yaml").string();
  for (const char* content : {"", "map: one\n", "map: one\nbase_in_map: [1, 2]\n", "{[", "\x01\x02",
                              "map: one\nbase_in_map: [1, .nan, 2]\n"}) {
    std::ofstream(path) << content;
    try {
      readPoseFile(path);
      ADD_FAILURE() << "no error for " << content;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(writePoseFile((folder.path() / "none/pose.yaml").string(), savedPose()),
               std::runtime_error);
}

TEST(PoseFile, KeepsThePoseIfTheCalibrationIsDamaged) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "pose.yaml").string();
  writePoseFile(path, savedPose());
  const std::string whole = readWhole(path);
  EXPECT_EQ(readPoseFile(path)->calibration_problem, "");
  const std::string begin = whole.substr(0, whole.find("calibration:"));
  for (const char* damaged : {"calibration: {turn_scale: 1}\n", "calibration: [1, 2]\n",
                              "calibration: none\n", "calibration:\n  distance_scale: .nan\n"}) {
    std::ofstream(path) << begin << damaged;
    const std::optional<SavedPose> read = readPoseFile(path);
    ASSERT_TRUE(read) << damaged;
    EXPECT_EQ(read->base_in_map.x, 1.0) << damaged;
    EXPECT_EQ(read->odometry->stamp, 100.0) << damaged;
    EXPECT_FALSE(read->sensors) << damaged;
    EXPECT_NE(read->calibration_problem, "") << damaged;
  }
}

TEST(PoseFile, ACalibrationNeedsAFrameOfItsOwnForEachLidar) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "pose.yaml").string();
  std::vector<std::string> nine;
  for (int i = 0; i < 9; ++i) nine.push_back("laser_" + std::to_string(i));
  for (const std::vector<std::string>& frames :
       {std::vector<std::string>{"\"\""}, {"laser", "laser"}, nine}) {
    std::ofstream file(path);
    file << "map: one\nbase_in_map: [1, 2, 3]\ncalibration:\n  distance_scale: 1\n"
            "  odometry_delay: 0\n  turn_scale: 1\n  turn_offset: 0\n  turn_delay: 0\n  lidars:\n";
    for (const std::string& frame : frames) {
      file << "    - {frame: " << frame << ", range_bias: 0.02, scan_reversed: false}\n";
    }
    file.close();
    const std::optional<SavedPose> read = readPoseFile(path);
    ASSERT_TRUE(read) << frames.size();
    EXPECT_EQ(read->base_in_map.x, 1.0) << frames.size();
    EXPECT_FALSE(read->sensors) << frames.size();
    EXPECT_NE(read->calibration_problem.find("frame"), std::string::npos)
        << read->calibration_problem;
  }
}

TEST(PoseFile, NeedsNoCalibration) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "pose.yaml").string();
  std::ofstream(path) << "map: one\nbase_in_map: [1, 2, 3]\n";
  EXPECT_FALSE(readPoseFile(path)->sensors);
}

TEST(PoseFile, OfAnEarlierVersionHasTheCalibrationOfOneLidar) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "pose.yaml").string();
  std::ofstream(path) << "map: one\nbase_in_map: [1, 2, 3]\ncalibration:\n  distance_scale: 1\n"
                         "  odometry_delay: 0\n  turn_scale: 1\n  turn_offset: 0\n  turn_delay: 0\n"
                         "  range_bias: 0.02\n  scan_reversed: true\n";
  const std::optional<SavedPose> pose = readPoseFile(path);
  EXPECT_TRUE(pose->lidar_frames.empty());
  EXPECT_EQ(pose->sensors->odometry.scale_distance, 0.0);
  ASSERT_EQ(pose->sensors->lidars.size(), 1U);
  EXPECT_EQ(pose->sensors->lidars[0].range_bias, 0.02);
  EXPECT_TRUE(pose->sensors->lidars[0].scan_reversed);
}

TEST(ResumedPose, MovesWithOdometryThatHasRunOn) {
  const PoseEstimate start = resumedPose(savedPose(), OdometryPose{101.0, {13.0, 0.0, 0.0}});
  EXPECT_NEAR(start.base_in_map.x, 1.0 + 3.0 * std::cos(0.5), 1e-9);
  EXPECT_NEAR(start.base_in_map.y, 2.0 + 3.0 * std::sin(0.5), 1e-9);
  EXPECT_NEAR(std::sqrt(start.covariance(0, 0)), 0.25, 1e-9);
}

TEST(ResumedPose, IsTheSavedOneIfTheOdometryWasResetOrIsUnknown) {
  const auto expect_saved = [](const PoseEstimate& start) {
    EXPECT_EQ(start.base_in_map.x, 1.0);
    EXPECT_EQ(start.covariance(0, 0), 0.0);
  };
  expect_saved(resumedPose(savedPose(), std::nullopt));
  expect_saved(resumedPose(savedPose(), OdometryPose{130.0, {0.1, 0.0, 0.0}}));   // reset
  expect_saved(resumedPose(savedPose(), OdometryPose{5.0, {13.0, 0.0, 0.0}}));    // another time
  expect_saved(resumedPose(savedPose(), OdometryPose{101.0, {90.0, 0.0, 0.0}}));  // too fast
}

}  // namespace
}  // namespace racecar_mcl
