#include <gtest/gtest.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "evaluation/trajectory.h"
#include "support/replay_fixture.h"
#include "support/replay_run.h"

namespace racecar_mcl {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// updates.csv without update_ms, the only column that is not deterministic.
auto untimed(const std::string& path) {
  auto columns = readCsv(path);
  EXPECT_EQ(columns.erase("update_ms"), 1u);
  return columns;
}

TEST_F(Replay, localizesAndSaysHowWell) {
  const nlohmann::json all = summaryOf({"--bag", record("a.bag"), "--initial-pose-from-truth"});
  EXPECT_LT(all["position_error_m"]["rmse"], 0.05);

  std::vector<std::string> keys;
  for (const auto& item : all.items()) keys.push_back(item.key());
  const std::vector<std::string> expected{"duration_s",
                                          "gyro",
                                          "heading_error_deg",
                                          "lidars",
                                          "num_beams",
                                          "num_particles",
                                          "odometry_seen",
                                          "position_error_m",
                                          "real_time_factor",
                                          "scan_direction",
                                          "scans_seen",
                                          "scans_used",
                                          "seed",
                                          "sensor_model",
                                          "status_percent",
                                          "truth_stamps_skipped",
                                          "truth_stamps_used",
                                          "update_ms",
                                          "version"};
  EXPECT_EQ(keys, expected);
  for (const char* key : {"mean", "median", "p95", "max", "rmse", "final"}) {
    EXPECT_TRUE(all["position_error_m"][key].is_number()) << key;
  }
  EXPECT_EQ(all["position_error_m"].size(), 6u);
  EXPECT_EQ(all["heading_error_deg"].size(), 3u);
  EXPECT_EQ(all["update_ms"].size(), 3u);
  EXPECT_EQ(all["scans_seen"], 41);
  EXPECT_EQ(all["scans_used"], 41);
  EXPECT_EQ(all["odometry_seen"], 201);
  EXPECT_EQ(all["truth_stamps_used"], 201);
  EXPECT_EQ(all["truth_stamps_skipped"], 0);
  EXPECT_NEAR(all["duration_s"], 4.0, 1e-6);

  const Trajectory trajectory = readTum(path("out/trajectory.tum"));
  ASSERT_EQ(trajectory.size(), 201u) << "one row per distinct stamp";
  EXPECT_EQ(trajectory.front().stamp, 1500000000000000000);
  const std::vector<std::string> updates = linesOf(readWhole(path("out/updates.csv")));
  ASSERT_EQ(updates.size(), 42u);
  EXPECT_EQ(
      updates[0],
      "stamp,x,y,yaw,cov_xx,cov_xy,cov_xyaw,cov_yy,cov_yyaw,cov_yawyaw,"
      "effective_sample_size,beams,particles,log_likelihood,resampled,outcome,update_ms,"
      "clusters,inlier_ratio,obstructed,contradicted,unmapped,conflict,carried,range_bias,"
      "distance_scale,turn_scale,turned_by_gyro,level_along,level_across,level_heading,"
      "localizability_along,localizability_across,localizability_heading,lidar,status,reason");
  EXPECT_EQ(updates[1].substr(0, 21), "1500000000.000000000,");
}

TEST_F(Replay, withoutATruthTakesNoError) {
  RoomDrive drive;
  drive.truth = false;
  const nlohmann::json summary =
      summaryOf({"--bag", record("a.bag", drive), "--initial-pose", "0.8 1.0 0.1"});
  EXPECT_FALSE(summary.contains("position_error_m"));
  EXPECT_FALSE(summary.contains("truth_stamps_used"));
  EXPECT_EQ(summary["scans_used"], 41);
}

TEST_F(Replay, namesTheRangeMethodOnlyIfItCastsRays) {
  const std::vector<std::string> drive = {"--bag", record("a.bag", RoomDrive{}), "--initial-pose",
                                          "0.8 1.0 0.1"};
  const nlohmann::json field = summaryOf(drive);
  EXPECT_EQ(field["sensor_model"], "likelihood_field");
  EXPECT_FALSE(field.contains("range_method"));
  std::vector<std::string> rays = drive;
  rays.insert(rays.end(), {"--set", "sensor_model:=beam"});
  const nlohmann::json beam = summaryOf(rays);
  EXPECT_EQ(beam["sensor_model"], "beam");
  EXPECT_EQ(beam["range_method"], "simd");
}

TEST_F(Replay, repeatsItselfBitForBitAndFollowsTheSeed) {
  Arguments arguments{"--bag", record("a.bag"), "--initial-pose", "0.8 1.0 0.1", "--seed", "7"};
  summaryOf(arguments, "first");
  summaryOf(arguments, "second");
  arguments.back() = "8";
  EXPECT_EQ(summaryOf(arguments, "other")["seed"], 8);
  const std::string first = readWhole(path("first/trajectory.tum"));
  EXPECT_EQ(first, readWhole(path("second/trajectory.tum")));
  EXPECT_EQ(untimed(path("first/updates.csv")), untimed(path("second/updates.csv")));
  EXPECT_NE(first, readWhole(path("other/trajectory.tum")));
}

TEST_F(Replay, takesOdometryFromTfAsFromPoses) {
  RoomDrive drive;
  summaryOf(
      {"--bag", record("topic.bag", drive), "--motion-from", "pose", "--initial-pose-from-truth"},
      "topic");
  drive.odometry_as_tf = true;
  const nlohmann::json summary = summaryOf({"--bag", record("tf.bag", drive), "--motion-from", "tf",
                                            "--odom-frame", "/odom", "--initial-pose-from-truth"},
                                           "tf");
  EXPECT_LT(summary["position_error_m"]["rmse"], 0.05);
  EXPECT_EQ(summary["odometry_seen"], 201);
  EXPECT_EQ(readWhole(path("topic/trajectory.tum")), readWhole(path("tf/trajectory.tum")));
}

TEST_F(Replay, joinsBagsInTheOrderOfTheirTimes) {
  RoomDrive early;
  early.seconds = 2.0;
  RoomDrive late;
  late.begin = 2.02;
  const std::string second = record("2.bag", late);
  const std::string first = record("1.bag", early);
  summaryOf({"--bag", second, "--bag", first, "--initial-pose-from-truth"}, "parts");
  summaryOf({"--bag", record("a.bag"), "--initial-pose-from-truth"}, "whole");
  EXPECT_EQ(readWhole(path("parts/trajectory.tum")), readWhole(path("whole/trajectory.tum")));
}

TEST_F(Replay, startsFromATruthThatBeginsMidDriveBetweenOdometryMessages) {
  std::string truth;
  for (int tick = 101; tick < 200; ++tick) {
    const double seconds = tick / 50.0 + 0.007;
    const Pose2 pose = poseInRoom(seconds);
    char line[160];
    std::snprintf(line, sizeof(line), "%.6f %.9f %.9f 0 0 0 %.9f %.9f\n", 1500000000.0 + seconds,
                  pose.x, pose.y, std::sin(pose.yaw / 2), std::cos(pose.yaw / 2));
    truth += line;
  }
  const nlohmann::json summary =
      summaryOf({"--bag", record("a.bag"), "--truth", folder_.write("t.tum", truth),
                 "--initial-pose-from-truth"});
  EXPECT_LT(summary["position_error_m"]["max"], 0.15);
  EXPECT_EQ(summary["scans_seen"], 41);
  EXPECT_EQ(summary["scans_used"], 20) << "scans before the start are not used";
}

TEST_F(Replay, beginsAndEndsWhereItIsTold) {
  const Arguments part{"--bag", record("a.bag"), "--start", "1", "--duration", "2"};
  const auto with = [&part](Arguments more) {
    more.insert(more.begin(), part.begin(), part.end());
    return more;
  };
  const nlohmann::json summary = summaryOf(with({"--initial-pose-from-truth"}));
  EXPECT_EQ(summary["scans_seen"], 21);
  EXPECT_EQ(summary["scans_used"], 21) << "started at the first of them";
  EXPECT_EQ(summary["odometry_seen"], 101);
  EXPECT_NEAR(summary["duration_s"], 2.0, 1e-6);
  EXPECT_LT(summary["position_error_m"]["max"], 0.1) << "started at the pose at that time";
  const Trajectory trajectory = readTum(path("out/trajectory.tum"));
  EXPECT_EQ(trajectory.front().stamp, 1500000001000000000);
  EXPECT_EQ(trajectory.back().stamp, 1500000003000000000);

  EXPECT_LT(summaryOf(with({"--global"}))["position_error_m"]["final"], 0.1);
  const Pose2 there = poseInRoom(1.0);
  std::ostringstream pose;
  pose << there.x << ' ' << there.y << ' ' << there.yaw;
  EXPECT_LT(summaryOf(with({"--initial-pose", pose.str()}))["position_error_m"]["final"], 0.1);
}

TEST_F(Replay, countsTheStartFromTheBeginningOfTheEarliestBag) {
  RoomDrive early;
  early.seconds = 2.0;
  RoomDrive late;
  late.begin = 2.02;
  const nlohmann::json summary =
      summaryOf({"--bag", record("2.bag", late), "--bag", record("1.bag", early), "--start", "1.5",
                 "--initial-pose-from-truth"});
  EXPECT_NEAR(summary["duration_s"], 2.5, 1e-6);
  EXPECT_LT(summary["position_error_m"]["max"], 0.1);
}

TEST_F(Replay, takesTfFromBeforeTheStart) {
  RoomDrive drive;
  drive.odometry_as_tf = true;
  const nlohmann::json summary = summaryOf({"--bag", record("a.bag", drive), "--motion-from", "tf",
                                            "--start", "1", "--initial-pose-from-truth"});
  EXPECT_EQ(summary["odometry_seen"], 151);
  EXPECT_LT(summary["position_error_m"]["max"], 0.1);
}

TEST_F(Replay, readsFramesWithALeadingSlash) {
  RoomDrive drive;
  drive.frame_prefix = "/";
  EXPECT_LT(summaryOf({"--bag", record("a.bag", drive),
                       "--initial-pose-from-truth"})["position_error_m"]["rmse"],
            0.05);
}

TEST_F(Replay, takesTheLidarsPoseFromTheCommandLineWhereTfDoesNotTell) {
  RoomDrive drive;
  drive.transforms = false;
  Arguments arguments{"--bag", record("a.bag", drive), "--initial-pose-from-truth"};
  expectError(replay(arguments), {"'laser'", "'base_link'", "--laser-pose"});
  arguments.insert(arguments.end(), {"--laser-pose", "0.25 0 0"});
  EXPECT_LT(summaryOf(arguments)["position_error_m"]["rmse"], 0.05);
  arguments.back() = "-0.25 0 0";
  // An offset of 0.5 m: the scans contradict the map and correct the pose only in part.
  EXPECT_GT(summaryOf(arguments)["position_error_m"]["rmse"], 0.15) << "wrong extrinsics must show";
  const std::vector<std::string> status = readCsv(path("out/updates.csv")).at("status");
  EXPECT_LT(std::count(status.begin(), status.end(), "localized"), 35) << "of 41";
}

TEST_F(Replay, findsItselfAnywhereOnTheMap) {
  EXPECT_LT(summaryOf({"--bag", record("a.bag"), "--global"})["position_error_m"]["final"], 0.1);
}

TEST_F(Replay, takesParametersFromTheConfigThenFromSet) {
  const std::string config =
      folder_.write("c.yaml", "num_particles: 50\nnum_beams_per_particle: 40\n");
  const nlohmann::json summary =
      summaryOf({"--bag", record("a.bag"), "--initial-pose-from-truth", "--config", config, "--set",
                 "num_particles:=60", "--set", "sensor_model:=beam", "--set",
                 "range_method:=bresenham", "--motion-from", "pose"});
  EXPECT_EQ(summary["num_particles"], 60);
  EXPECT_EQ(summary["num_beams"], 40);
  EXPECT_EQ(summary["range_method"], "bresenham");
  EXPECT_LT(summary["position_error_m"]["rmse"], 0.05);
}

TEST_F(Replay, replacesItsThreeFilesAndLeavesOthers) {
  folder_.write("out/summary.json", "old");
  folder_.write("out/notes.txt", "mine");
  EXPECT_EQ(summaryOf({"--bag", record("a.bag"), "--initial-pose-from-truth"})["scans_used"], 41);
  EXPECT_EQ(readWhole(path("out/notes.txt")), "mine");
  std::size_t folders = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
    folders += entry.is_directory() ? 1 : 0;
  }
  EXPECT_EQ(folders, 1u) << "no temporary folders remain";
}

TEST_F(Replay, skipsTruthStampsInGapsOfTheEstimate) {
  const std::string truth = folder_.write("t.tum",
                                          "1500000000.00 0.8 1.0 0 0 0 0.05 0.9987\n"
                                          "1500000001.01 1.8 1.1 0 0 0 0.1 0.995\n");
  const nlohmann::json summary = summaryOf({"--bag", record("a.bag"), "--initial-pose-from-truth",
                                            "--truth", truth, "--max-gap", "0.001"});
  EXPECT_EQ(summary["truth_stamps_used"], 1);
  EXPECT_EQ(summary["truth_stamps_skipped"], 1);
}

TEST_F(Replay, printsAndStoresTheStatusOfTheDrive) {
  const ProgramResult result = replay({"--bag", record("a.bag"), "--initial-pose-from-truth"});
  EXPECT_NE(result.out.find("\nstatus: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("localized "), std::string::npos) << result.out;
  const auto summary = nlohmann::json::parse(readWhole(path("out/summary.json")));
  double sum = 0.0;
  for (const auto& percent : summary["status_percent"]) sum += percent.get<double>();
  EXPECT_NEAR(sum, 100.0, 1e-9);
  EXPECT_GT(summary["status_percent"]["localized"], 50.0);
}

}  // namespace
}  // namespace racecar_mcl
