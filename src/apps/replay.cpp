// Runs the localizer on recorded bags, offline, and reports its accuracy.
#include <unistd.h>

#include <algorithm>
#include <boost/version.hpp>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>
#if BOOST_VERSION >= 107200
#include <boost/timer/progress_display.hpp>
using ProgressBar = boost::timer::progress_display;
#else
#include <boost/progress.hpp>
using ProgressBar = boost::progress_display;
#endif

#include "cli.h"
#include "evaluation/trajectory.h"
#include "evaluation/trajectory_error.h"
#include "file_options.h"
#include "lidar_options.h"
#include "offline/bag_reader.h"
#include "offline/offline_driver.h"
#include "offline/output_files.h"
#include "offline/particle_recorder.h"
#include "offline/replay_report.h"
#include "offline/video/video_recorder.h"
#include "parameter_options.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "racecar_mcl/map/map_io.h"
#include "ros/localization/node_parameters.h"

namespace racecar_mcl {
namespace {

constexpr char kTruthTopic[] = "/ground_truth/odom";
// Initial standard deviations with --initial-pose-from-truth.
constexpr double kTruthSigma = 0.1;      // m
constexpr double kTruthYawSigma = 0.05;  // rad

struct Options {
  std::vector<std::string> bags;
  BagSpan span;
  std::string map;
  std::string out;
  ParameterOptions parameters;
  std::string initial_pose;
  bool initial_pose_from_truth = false;
  bool global = false;
  std::string truth;
  std::uint64_t seed = 1;
  std::string scan_topic = "/scan";
  std::string odom_topic = "/vesc/odom";
  std::string imu_topic;
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string laser_pose;
  std::string motion_from;
  double max_gap = 0.5;
  VideoParameters video;  ///< no video if the path is empty
  std::string particles;
  double particles_period = 1.0;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--bag", o->bags, "recorded bag; may be repeated")->required();
  app->add_option("--map", o->map, "map YAML file")->required();
  app->add_option("--out", o->out, "output folder for trajectory.tum, updates.csv and summary.json")
      ->required();
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
  app->add_option("--scan-topic", o->scan_topic, "sensor_msgs/LaserScan")->capture_default_str();
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--imu-topic", o->imu_topic, "sensor_msgs/Imu, for its gyro [none]");
  app->add_option("--odom-frame", o->odom_frame, "odometry frame, with --motion-from tf")
      ->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "localized frame")->capture_default_str();
  app->add_option("--laser-pose", o->laser_pose,
                  "\"x y yaw\" of the lidar in base_frame, instead of the bag's tf");
  app->add_option("--motion-from", o->motion_from, "source of odometry: twist, pose or tf");
  app->add_option("--max-gap", o->max_gap,
                  "maximum interval between estimates for error evaluation, s")
      ->capture_default_str();
  app->add_option("--video", o->video.path, "output video, such as run.mp4");
  app->add_option("--video-speed", o->video.speed, "recorded seconds per second of video")
      ->capture_default_str();
  app->add_option("--video-width", o->video.width, "visible width, m")->capture_default_str();
  app->add_option("--particles", o->particles, "output CSV file for particle sets");
  app->add_option("--particles-period", o->particles_period,
                  "minimum interval between particle sets, s")
      ->capture_default_str();
  app->footer(std::string("Without --truth, ") + kTruthTopic +
              " (nav_msgs/Odometry) of the bag is the ground truth, if present.");
}

LocalizerParameters parametersOf(const Options& o) {
  LocalizerParameters parameters = readParameters(o.parameters);
  if (!o.motion_from.empty()) setParameter("motion_from", o.motion_from, &parameters);
  return parameters;
}

/// The ground truth from the file, else from the bag, if present.
std::optional<Trajectory> readTruth(const Options& o, const BagReader& bags) {
  if (!o.truth.empty()) return readTum(o.truth);
  if (bags.hasTopic(kTruthTopic, "nav_msgs/Odometry")) return bags.readPoses(kTruthTopic);
  return std::nullopt;
}

/// The first pose of the truth at `begin` or later.
std::optional<TimedStart> startFromTruth(const std::optional<Trajectory>& truth,
                                         Nanoseconds begin) {
  if (!truth) {
    throw ParameterError(std::string("--initial-pose-from-truth requires --truth or ") +
                         kTruthTopic + " in the bag");
  }
  const auto first = std::find_if(truth->begin(), truth->end(),
                                  [&](const StampedPose& pose) { return pose.stamp >= begin; });
  if (first == truth->end()) {
    throw TrajectoryError("the truth covers " + spanOf(*truth) +
                          " s, which has no pose after --start (" + formatStamp(begin) + " s)");
  }
  TimedStart start{first->stamp, {first->pose, Eigen::Matrix3d::Zero()}};
  start.estimate.covariance.diagonal() << kTruthSigma * kTruthSigma, kTruthSigma * kTruthSigma,
      kTruthYawSigma * kTruthYawSigma;
  return start;
}

/// Initializes the localizer, or returns a start at a later time.
std::optional<TimedStart> start(const Options& o, const BagReader& bags,
                                const std::optional<Trajectory>& truth, Localizer* localizer) {
  if (o.initial_pose_from_truth) {
    const bool at_beginning = o.span.start == 0.0;
    return startFromTruth(truth, at_beginning ? std::numeric_limits<Nanoseconds>::min()
                                              : bags.firstScanStamp(o.scan_topic));
  }
  if (!o.initial_pose.empty()) {
    localizer->initialize({parsePose("--initial-pose", o.initial_pose), Eigen::Matrix3d::Zero()});
  } else {
    localizer->initializeGlobally();
  }
  return std::nullopt;
}

std::optional<TrajectoryErrors> errorsOf(const Trajectory& estimate,
                                         const std::optional<Trajectory>& truth, double max_gap) {
  if (!truth) return std::nullopt;
  const TrajectoryErrors errors = compareTrajectories(estimate, *truth, max_gap);
  if (errors.stamps_used == 0) {
    throw TrajectoryError("cannot evaluate errors: the truth covers " + spanOf(*truth) +
                          " s, the estimate " + spanOf(estimate) + " s, and " +
                          std::to_string(errors.stamps_skipped) +
                          " common stamps are in gaps longer than --max-gap");
  }
  return errors;
}

void warnAboutDroppedMessages(const ReplayRecord& record) {
  for (const auto& [reason, count] : record.dropped) {
    std::cerr << "replay: warning: " << count << " x " << reason << '\n';
  }
  if (!record.clock_problem.empty()) {
    std::cerr << "replay: warning: " << record.clock_problem << '\n';
  }
}

/// Throws BagError if the recording did not localize the car.
void requireResult(const ReplayRecord& record) {
  if (record.trajectory.empty()) {
    throw BagError("no pose was estimated: the recording ends before the localizer is initialized");
  }
  if (record.scans.empty()) {
    throw BagError("none of the " + std::to_string(record.scans_seen) +
                   " scans was used; expected scans from which the localizer can estimate poses");
  }
}

void useImu(const Options& o, const BagReader& bags, ReplayInput* input) {
  bags.requireTopic(o.imu_topic, "sensor_msgs/Imu", "--imu-topic");
  input->imu_topic = o.imu_topic;
  const std::optional<geometry_msgs::Quaternion> rotation =
      bags.imuRotation(o.imu_topic, o.base_frame);
  if (!rotation) {
    std::cerr << "replay: warning: the bag has no transform from '" << o.base_frame
              << "' to the IMU's frame; its axes are taken as those of the car" << std::endl;
  }
  input->imu_rotation = rotation.value_or(quaternionOf(0.0));
}

void warnAboutImu(const ReplayRecord& record, const GyroCalibration& gyro) {
  if (!record.imu_rejection.empty()) {
    std::cerr << "replay: warning: no gyro: " << record.imu_rejection << std::endl;
  }
  if (gyro.isInDegrees()) {
    std::cerr << "replay: warning: the IMU publishes degrees per second instead of rad/s; its "
                 "samples were converted"
              << std::endl;
  }
  if (gyro.use() == GyroUse::kWrong) {
    std::cerr << "replay: warning: gyro " << toString(gyro.use()) << " (the scans turn "
              << gyro.ratio() << " times as far)" << std::endl;
  }
}

void validate(const Options& o) {
  std::vector<std::string> outputs = filesIn(o.out, reportFiles());
  outputs.insert(outputs.end(), {o.video.path, o.particles});
  std::vector<std::string> inputs = mapFiles(o.map);
  inputs.insert(inputs.end(), o.bags.begin(), o.bags.end());
  inputs.insert(inputs.end(), {o.truth, o.parameters.config});
  requireSeparateFiles(outputs, inputs);
  requireNotNegative("--max-gap", o.max_gap, "s");
  requireNotNegative("--start", o.span.start, "s");
  require(o.span.duration > 0.0, "--duration", o.span.duration, "positive", "s");
}

void replay(const Options& o) {
  validate(o);
  const LocalizerParameters parameters = parametersOf(o);
  Localizer localizer(parameters, o.seed);
  localizer.setMap(makeLocalizationMap(loadMap(o.map), parameters));

  const BagReader bags(o.bags, o.span);
  bags.requireTopic(o.scan_topic, "sensor_msgs/LaserScan", "--scan-topic");
  const bool from_tf = parameters.odometry.motion_from == MotionFrom::kTf;
  if (!from_tf) bags.requireTopic(o.odom_topic, "nav_msgs/Odometry", "--odom-topic");
  const std::optional<Trajectory> truth = readTruth(o, bags);

  ReplayInput input;
  input.scan_topic = o.scan_topic;
  input.odometry_topic = o.odom_topic;
  if (from_tf) {
    input.odometry_from_tf = {o.odom_frame, o.base_frame, parameters.odometry.clock_jump};
  }
  input.extrinsics = lidarExtrinsics(o.laser_pose, bags, o.scan_topic, o.base_frame);
  if (!o.imu_topic.empty()) useImu(o, bags, &input);
  input.start = start(o, bags, truth, &localizer);

  std::unique_ptr<ProgressBar> bar;
  if (isatty(STDERR_FILENO) != 0) {
    std::vector<std::string> topics{o.scan_topic, from_tf ? "/tf" : o.odom_topic};
    if (!o.imu_topic.empty()) topics.push_back(o.imu_topic);
    bar = std::make_unique<ProgressBar>(bags.count(topics), std::cerr, "");
  }
  std::vector<ReplayObserver*> observers;
  std::unique_ptr<VideoRecorder> video;
  if (!o.video.path.empty()) {
    video = std::make_unique<VideoRecorder>(o.video, localizer.map()->grid, truth, o.max_gap);
    observers.push_back(video.get());
  }
  ParticleRecorder particles(o.particles_period);
  if (!o.particles.empty()) observers.push_back(&particles);
  const auto progress = [&] {
    if (bar) ++*bar;
  };
  const ReplayRecord record = runReplay(bags, input, &localizer, progress, observers);
  warnAboutDroppedMessages(record);
  warnAboutImu(record, localizer.calibration().gyro());
  requireResult(record);
  const std::optional<TrajectoryErrors> errors = errorsOf(record.trajectory, truth, o.max_gap);

  const ReplayMetadata description{parameters,
                                   o.seed,
                                   RACECAR_MCL_VERSION,
                                   localizer.counters(),
                                   localizer.scanDirection().word(),
                                   toString(localizer.calibration().gyro().use())};
  writeReport(o.out, record, summaryJson(record, description, errors));
  if (video) video->finish();
  if (!o.particles.empty()) writeFile(o.particles, particles.csv());
  std::cout << summaryText(record, description, errors) << std::endl;
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "replay",
      "Runs the localizer on recorded bags; writes trajectory.tum, updates.csv and summary.json.",
      racecar_mcl::addOptions, racecar_mcl::replay);
}
