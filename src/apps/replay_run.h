// Runs a localizer over the bags of ReplayOptions, and reports on stderr what was dropped.
#pragma once

#include <unistd.h>

#include <boost/version.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#if BOOST_VERSION >= 107200
#include <boost/timer/progress_display.hpp>
using ProgressBar = boost::timer::progress_display;
#else
#include <boost/progress.hpp>
using ProgressBar = boost::progress_display;
#endif

#include "lidar_options.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "racecar_mcl/map/map_io.h"
#include "replay_start.h"

namespace racecar_mcl {

/// A localizer that has started, or starts with `input`, and what it runs over.
struct PreparedReplay {
  LocalizerParameters parameters;
  std::unique_ptr<Localizer> localizer;
  std::unique_ptr<const BagReader> bags;  ///< the input refers to it
  std::optional<Trajectory> truth;
  ReplayInput input;
};

inline LocalizerParameters parametersOf(const ReplayOptions& o) {
  LocalizerParameters parameters = readParameters(o.parameters);
  if (!o.motion_from.empty()) setParameter("motion_from", o.motion_from, &parameters);
  return parameters;
}

inline void warnAboutDroppedMessages(const std::string& program, const ReplayRecord& record) {
  for (const auto& [reason, count] : record.dropped) {
    std::cerr << program << ": warning: " << count << " x " << reason << '\n';
  }
  if (!record.clock_problem.empty()) {
    std::cerr << program << ": warning: " << record.clock_problem << '\n';
  }
}

inline void warnAboutImu(const std::string& program, const ReplayRecord& record,
                         const GyroCalibration& gyro) {
  if (!record.imu_rejection.empty()) {
    std::cerr << program << ": warning: no gyro: " << record.imu_rejection << std::endl;
  }
  if (gyro.isInDegrees()) {
    std::cerr << program
              << ": warning: the IMU publishes degrees per second instead of rad/s; its "
                 "samples were converted"
              << std::endl;
  }
  if (gyro.use() == GyroUse::kWrong) {
    std::cerr << program << ": warning: gyro " << toString(gyro.use()) << " (the scans turn "
              << gyro.ratio() << " times as far)" << std::endl;
  }
}

inline void useImu(const ReplayOptions& o, const std::string& program, const BagReader& bags,
                   ReplayInput* input) {
  bags.requireTopic(o.imu_topic, "sensor_msgs/Imu", "--imu-topic");
  input->imu_topic = o.imu_topic;
  const std::optional<geometry_msgs::Quaternion> rotation =
      bags.imuRotation(o.imu_topic, o.base_frame);
  if (!rotation) {
    std::cerr << program << ": warning: the bag has no transform from '" << o.base_frame
              << "' to the IMU's frame; its axes are taken as those of the car" << std::endl;
  }
  input->imu_rotation = rotation.value_or(quaternionOf(0.0));
}

inline ReplayInput replayInput(const ReplayOptions& o, const std::string& program,
                               const LocalizerParameters& parameters, const BagReader& bags) {
  for (const std::string& topic : o.scan_topics) {
    bags.requireTopic(topic, "sensor_msgs/LaserScan", "--scan-topic");
  }
  ReplayInput input;
  input.scan_topics = o.scan_topics;
  input.odometry_topic = o.odom_topic;
  if (parameters.odometry.motion_from == MotionFrom::kTf) {
    input.odometry_from_tf = {o.odom_frame, o.base_frame, parameters.odometry.clock_jump};
  } else {
    bags.requireTopic(o.odom_topic, "nav_msgs/Odometry", "--odom-topic");
  }
  input.extrinsics_of = lidarExtrinsicsByFrame(o.laser_pose, bags, o.base_frame);
  // Throws now if the pose of a lidar is missing, not in the middle of the drive.
  for (const std::string& topic : o.scan_topics) {
    input.extrinsics_of(o.laser_pose.empty() ? bags.requireScanFrame(topic)
                                             : bags.scanFrame(topic));
  }
  if (!o.imu_topic.empty()) useImu(o, program, bags, &input);
  return input;
}

/// Reads map, parameters and truth, and opens the bags. `program`: its name, for warnings.
inline PreparedReplay prepareReplay(const ReplayOptions& o, const std::string& program) {
  const LocalizerParameters parameters = parametersOf(o);
  auto localizer = std::make_unique<Localizer>(parameters, o.seed);
  localizer->setMap(makeLocalizationMap(loadMap(o.map), parameters));
  auto bags = std::make_unique<const BagReader>(o.bags, o.span);
  ReplayInput input = replayInput(o, program, parameters, *bags);
  std::optional<Trajectory> truth = readTruth(o, *bags);
  input.start = start(o, *bags, truth, localizer.get());
  return {parameters, std::move(localizer), std::move(bags), std::move(truth), std::move(input)};
}

/// Shows the progress if stderr is a terminal.
inline ReplayRecord runReplay(const ReplayOptions& o, const std::string& program,
                              const PreparedReplay& prepared,
                              const std::vector<ReplayObserver*>& observers) {
  std::unique_ptr<ProgressBar> bar;
  if (isatty(STDERR_FILENO) != 0) {
    std::vector<std::string> topics = o.scan_topics;
    topics.push_back(prepared.input.odometry_from_tf ? "/tf" : o.odom_topic);
    if (!o.imu_topic.empty()) topics.push_back(o.imu_topic);
    bar = std::make_unique<ProgressBar>(prepared.bags->count(topics), std::cerr, "");
  }
  const auto progress = [&] {
    if (bar) ++*bar;
  };
  ReplayRecord record =
      runReplay(*prepared.bags, prepared.input, prepared.localizer.get(), progress, observers);
  warnAboutDroppedMessages(program, record);
  warnAboutImu(program, record, prepared.localizer->calibration().gyro());
  return record;
}

}  // namespace racecar_mcl
