// Options of the programs that run a localizer over recorded bags.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "offline/bag_reader.h"
#include "parameter_options.h"
#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {

constexpr char kTruthTopic[] = "/ground_truth/odom";

struct ReplayOptions {
  std::vector<std::string> bags;
  BagSpan span;
  std::string map;
  ParameterOptions parameters;
  std::string initial_pose;
  bool initial_pose_from_truth = false;
  bool global = false;
  std::string truth;
  std::uint64_t seed = 1;
  std::vector<std::string> scan_topics{"/scan"};
  std::string odom_topic = "/vesc/odom";
  std::string imu_topic;
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string laser_pose;
  std::string motion_from;
};

/// All but --bag and the map.
inline void addReplayOptions(ReplayOptions* o, CLI::App* app) {
  addParameterOptions(&o->parameters, app);
  app->add_option("--start", o->span.start, "start of the replayed part, s into the recording")
      ->capture_default_str();
  app->add_option("--duration", o->span.duration, "duration of the replayed part, s [to the end]");
  CLI::Option* pose = app->add_option("--initial-pose", o->initial_pose,
                                      "start pose \"x y yaw\" at the first message");
  CLI::Option* from_truth = app->add_flag("--initial-pose-from-truth", o->initial_pose_from_truth,
                                          "start at the first pose of the truth (after --start) "
                                          "and at its time");
  app->add_flag("--global", o->global, "global localization (default without a start pose)")
      ->excludes(pose)
      ->excludes(from_truth);
  pose->excludes(from_truth);
  app->add_option("--truth", o->truth, "ground truth, a TUM file");
  app->add_option("--seed", o->seed, "random seed")->capture_default_str();
  app->add_option("--scan-topic", o->scan_topics,
                  "sensor_msgs/LaserScan; several for several lidars")
      ->delimiter(' ')
      ->capture_default_str();
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--imu-topic", o->imu_topic, "sensor_msgs/Imu, for its gyro [none]");
  app->add_option("--odom-frame", o->odom_frame, "odometry frame, with --motion-from tf")
      ->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "localized frame")->capture_default_str();
  app->add_option("--laser-pose", o->laser_pose,
                  "\"x y yaw\" of the lidar in base_frame, instead of the bag's tf");
  app->add_option("--motion-from", o->motion_from, "source of odometry: twist, pose or tf");
}

/// Throws ParameterError.
inline void validateSpan(const BagSpan& span) {
  requireNotNegative("--start", span.start, "s");
  require(span.duration > 0.0, "--duration", span.duration, "positive", "s");
}

}  // namespace racecar_mcl
