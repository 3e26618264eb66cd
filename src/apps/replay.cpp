// Localizes over recorded bags, without a ROS master and as fast as it goes, and says how well.
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

#include "bag_reader.h"
#include "evaluation/trajectory.h"
#include "evaluation/trajectory_error.h"
#include "output_files.h"
#include "parameter_options.h"
#include "particle_table.h"
#include "program.h"
#include "racecar_mcl/errors.h"
#include "racecar_mcl/localizer.h"
#include "racecar_mcl/map_io.h"
#include "racecar_mcl/parameters.h"
#include "racecar_mcl/require.h"
#include "replay_outputs.h"
#include "replay_run.h"
#include "ros/node_parameters.h"
#include "video.h"

namespace racecar_mcl {
namespace {

constexpr char kTruthTopic[] = "/ground_truth/odom";
// How well a truth is taken to be known where the localizer starts from it.
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
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string laser_pose;
  std::string motion_from;
  double max_gap = 0.5;
  VideoParameters video;  ///< no film where the path is empty
  std::string particles;
  double particles_period = 1.0;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--bag", o->bags, "a recording; may be given several times")->required();
  app->add_option("--map", o->map, "the map's YAML file")->required();
  app->add_option("--out", o->out, "folder for trajectory.tum, updates.csv and summary.json")
      ->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--start", o->span.start, "begin so many s into the recording")
      ->capture_default_str();
  app->add_option("--duration", o->span.duration, "and end so many s later [at the end]");
  CLI::Option* pose = app->add_option("--initial-pose", o->initial_pose,
                                      "\"x y yaw\" in the map, at the first message");
  CLI::Option* from_truth = app->add_flag("--initial-pose-from-truth", o->initial_pose_from_truth,
                                          "start from the truth's first pose, when it holds; "
                                          "with --start its first from there on");
  app->add_flag("--global", o->global, "start anywhere on the map; so does no start at all")
      ->excludes(pose)
      ->excludes(from_truth);
  pose->excludes(from_truth);
  app->add_option("--truth", o->truth, "the true trajectory, a TUM file");
  app->add_option("--seed", o->seed, "of every random number")->capture_default_str();
  app->add_option("--scan-topic", o->scan_topic, "sensor_msgs/LaserScan")->capture_default_str();
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--odom-frame", o->odom_frame, "with --motion-from tf, the odometry's frame")
      ->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "the frame that is localized")
      ->capture_default_str();
  app->add_option("--laser-pose", o->laser_pose,
                  "\"x y yaw\" of the lidar on the car, instead of the bag's tf");
  app->add_option("--motion-from", o->motion_from,
                  "twist, pose or tf: what odometry is taken from");
  app->add_option("--max-gap", o->max_gap,
                  "s; no error is taken where estimates lie further apart than this")
      ->capture_default_str();
  app->add_option("--video", o->video.path, "a film of the run: a name that ends in .mp4");
  app->add_option("--video-speed", o->video.speed, "recorded seconds per second of film")
      ->capture_default_str();
  app->add_option("--video-width", o->video.width, "m that the film shows from left to right")
      ->capture_default_str();
  app->add_option("--particles", o->particles, "a CSV file for the particle sets");
  app->add_option("--particles-period", o->particles_period, "s between two of them at least")
      ->capture_default_str();
  app->footer(std::string("Without --truth, ") + kTruthTopic +
              " (nav_msgs/Odometry) is the truth where a bag holds it.");
}

LocalizerParameters parametersOf(const Options& o) {
  LocalizerParameters parameters = readParameters(o.parameters);
  if (!o.motion_from.empty()) setParameter("motion_from", o.motion_from, &parameters);
  return parameters;
}

/// The truth from a file or from the bag; none where there is neither.
std::optional<Trajectory> readTruth(const Options& o, const BagReader& bags) {
  if (!o.truth.empty()) return readTum(o.truth);
  if (bags.hasTopic(kTruthTopic, "nav_msgs/Odometry")) return bags.readPoses(kTruthTopic);
  return std::nullopt;
}

/// From the first pose that holds at `begin` or later.
std::optional<TimedStart> startFromTruth(const std::optional<Trajectory>& truth,
                                         Nanoseconds begin) {
  if (!truth) {
    throw ParameterError(std::string("--initial-pose-from-truth needs --truth or ") + kTruthTopic +
                         " in the bag");
  }
  const auto first = std::find_if(truth->begin(), truth->end(),
                                  [&](const StampedPose& pose) { return pose.stamp >= begin; });
  if (first == truth->end()) {
    throw TrajectoryError("the truth covers " + spanOf(*truth) + " s and so no pose from " +
                          formatStamp(begin) + " s on, where --start lies");
  }
  TimedStart start{first->stamp, {first->pose, Eigen::Matrix3d::Zero()}};
  start.estimate.covariance.diagonal() << kTruthSigma * kTruthSigma, kTruthSigma * kTruthSigma,
      kTruthYawSigma * kTruthYawSigma;
  return start;
}

/// Starts the localizer now, or says when it is to be started.
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
    throw TrajectoryError("no error can be taken: the truth covers " + spanOf(*truth) +
                          " s, the estimate " + spanOf(estimate) + " s, and " +
                          std::to_string(errors.stamps_skipped) +
                          " stamps in common lie in gaps over --max-gap");
  }
  return errors;
}

void warnAbout(const ReplayRecord& record) {
  if (record.scans_refused == 0) return;
  std::cerr << "replay: warning: " << record.scans_refused << " of " << record.scans_seen
            << " scans are not usable; the first because " << record.first_refusal << std::endl;
}

void validate(const Options& o) {
  requireNotNegative("--max-gap", o.max_gap, "s");
  requireNotNegative("--start", o.span.start, "s");
  require(o.span.duration > 0.0, "--duration", o.span.duration, "positive", "s");
}

void replay(const Options& o) {
  validate(o);
  const LocalizerParameters parameters = parametersOf(o);
  Localizer localizer(parameters, o.seed);
  localizer.setMap(makeMapModel(loadMap(o.map), parameters));

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
  input.mount = o.laser_pose.empty() ? bags.laserMount(o.scan_topic, o.base_frame)
                                     : LaserMount{parsePose("--laser-pose", o.laser_pose), false};
  input.start = start(o, bags, truth, &localizer);

  std::unique_ptr<ProgressBar> bar;
  if (isatty(STDERR_FILENO) != 0) {
    bar = std::make_unique<ProgressBar>(bags.count({o.scan_topic, from_tf ? "/tf" : o.odom_topic}),
                                        std::cerr, "");
  }
  std::vector<ReplayObserver*> observers;
  std::unique_ptr<VideoRecorder> video;
  if (!o.video.path.empty()) {
    video = std::make_unique<VideoRecorder>(o.video, localizer.map()->grid, truth, o.max_gap);
    observers.push_back(video.get());
  }
  ParticleTable particles(o.particles_period);
  if (!o.particles.empty()) observers.push_back(&particles);
  const auto progress = [&] {
    if (bar) ++*bar;
  };
  const ReplayRecord record = runReplay(bags, input, &localizer, progress, observers);
  warnAbout(record);
  if (record.trajectory.empty()) {
    throw BagError("no pose was estimated: the recording ended before the localizer was started");
  }
  const std::optional<TrajectoryErrors> errors = errorsOf(record.trajectory, truth, o.max_gap);

  const RunDescription description{parameters, o.seed, RACECAR_MCL_VERSION, localizer.counters(),
                                   localizer.sweepOrder().word()};
  writeOutputs(o.out, record, summaryJson(record, description, errors));
  if (video) video->finish();
  if (!o.particles.empty()) writeFile(o.particles, particles.csv());
  std::cout << summaryText(record, description, errors) << std::endl;
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "replay",
      "Localizes over recorded bags and writes trajectory.tum, updates.csv, summary.json.",
      racecar_mcl::addOptions, racecar_mcl::replay);
}
