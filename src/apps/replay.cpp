// Runs the localizer on recorded bags, offline, and reports its accuracy.
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli.h"
#include "evaluation/trajectory_error.h"
#include "file_options.h"
#include "offline/output_files.h"
#include "offline/particle_recorder.h"
#include "offline/replay_report.h"
#include "offline/video/video_recorder.h"
#include "replay_run.h"

namespace racecar_mcl {
namespace {

struct Options : ReplayOptions {
  std::string out;
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
  addReplayOptions(o, app);
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

void validate(const Options& o) {
  std::vector<std::string> outputs = filesIn(o.out, reportFiles());
  outputs.insert(outputs.end(), {o.video.path, o.particles});
  std::vector<std::string> inputs = mapFiles(o.map);
  inputs.insert(inputs.end(), o.bags.begin(), o.bags.end());
  inputs.insert(inputs.end(), {o.truth, o.parameters.config});
  requireSeparateFiles(outputs, inputs);
  requireNotNegative("--max-gap", o.max_gap, "s");
  validateSpan(o.span);
}

void replay(const Options& o) {
  validate(o);
  const PreparedReplay prepared = prepareReplay(o, "replay");
  const Localizer& localizer = *prepared.localizer;
  const std::optional<Trajectory>& truth = prepared.truth;
  std::vector<ReplayObserver*> observers;
  std::unique_ptr<VideoRecorder> video;
  if (!o.video.path.empty()) {
    video = std::make_unique<VideoRecorder>(o.video, localizer.map()->grid, truth, o.max_gap);
    observers.push_back(video.get());
  }
  ParticleRecorder particles(o.particles_period);
  if (!o.particles.empty()) observers.push_back(&particles);
  const ReplayRecord record = runReplay(o, "replay", prepared, observers);
  requireResult(record);
  const std::optional<TrajectoryErrors> errors = errorsOf(record.trajectory, truth, o.max_gap);

  const ReplayMetadata description{
      prepared.parameters,           o.seed,
      RACECAR_MCL_VERSION,           localizer.counters(),
      localizer.sensorCalibration(), toString(localizer.calibration().gyro().use())};
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
