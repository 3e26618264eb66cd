// Particle sets of one filter cycle, as in figures 2 and 3 of the course report.
#include <fstream>
#include <iomanip>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "evaluation/trajectory.h"
#include "file_options.h"
#include "offline/bag_reader.h"
#include "offline/output_files.h"
#include "parameter_options.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/filter/particle_filter.h"
#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/localizer/parameter_registry.h"
#include "racecar_mcl/map/map_io.h"

namespace racecar_mcl {
namespace {

struct Options {
  std::string bag;
  std::string map;
  std::string truth;
  std::string out;
  ParameterOptions parameters;
  double at = 5.0;
  double drive = 0.5;
  std::uint64_t seed = 1;
  std::string scan_topic = "/scan";
  std::string odom_topic = "/vesc/odom";
  std::string base_frame = "base_link";
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--bag", o->bag, "recorded bag")->required();
  app->add_option("--map", o->map, "map YAML file")->required();
  app->add_option("--truth", o->truth, "ground truth, a TUM file")->required();
  app->add_option("--out", o->out, "output CSV file")->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--at", o->at,
                  "start with the first scan after this time, s after the truth's beginning")
      ->capture_default_str();
  app->add_option("--drive", o->drive, "time between the two scans, s")->capture_default_str();
  app->add_option("--seed", o->seed, "random seed")->capture_default_str();
  app->add_option("--scan-topic", o->scan_topic, "sensor_msgs/LaserScan")->capture_default_str();
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "localized frame")->capture_default_str();
}

/// The messages of the cycle: odometry, and the scans at its beginning and end.
struct Excerpt {
  std::vector<OdometrySample> odometry;  ///< from the first scan to the second
  std::optional<Scan> first;
  std::optional<Scan> second;
};

Excerpt readExcerpt(const BagReader& bag, const Options& o, double begin) {
  const LidarExtrinsics extrinsics = bag.lidarExtrinsics(o.scan_topic, o.base_frame);
  Excerpt excerpt;
  bag.forEach({{o.scan_topic}, o.odom_topic}, [&](const BagEvent& event) {
    if (excerpt.second) return;
    if (event.odometry) {
      excerpt.odometry.push_back(toOdometrySample(*event.odometry));
    } else if (event.scan->header.stamp.toSec() >= begin && !excerpt.first) {
      excerpt.first = toScan(*event.scan, extrinsics);
    } else if (excerpt.first &&
               event.scan->header.stamp.toSec() >= excerpt.first->stamp + o.drive) {
      excerpt.second = toScan(*event.scan, extrinsics);
    }
  });
  if (!excerpt.second) {
    throw BagError(o.bag + ": ends before " + std::to_string(o.at + o.drive) +
                   " s after the truth's beginning");
  }
  return excerpt;
}

void append(const std::string& step, double stamp, const ParticleSet& particles,
            std::ostream& table) {
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    table << step << ',' << stamp << ',' << particles.x[i] << ',' << particles.y[i] << ','
          << particles.yaw[i] << '\n';
  }
}

void run(const Options& o) {
  std::vector<std::string> inputs = mapFiles(o.map);
  inputs.insert(inputs.end(), {o.bag, o.truth, o.parameters.config});
  requireSeparateFiles({o.out}, inputs);
  LocalizerParameters parameters = readParameters(o.parameters);
  // Resample after every update, without regularization.
  parameters.filter.resample_threshold = 1.0;
  parameters.filter.regularization_updates = 0;
  validate(parameters);
  const std::shared_ptr<const LocalizationMap> map =
      makeLocalizationMap(loadMap(o.map), parameters);
  const Trajectory truth = readTum(o.truth);
  const BagReader bag({o.bag});
  bag.requireTopic(o.scan_topic, "sensor_msgs/LaserScan", "--scan-topic");
  bag.requireTopic(o.odom_topic, "nav_msgs/Odometry", "--odom-topic");
  const Excerpt excerpt = readExcerpt(bag, o, toSeconds(truth.front().stamp) + o.at);
  const double begin = excerpt.first->stamp, end = excerpt.second->stamp;
  const std::optional<Pose2> start = poseAt(truth, toNanoseconds(begin), 1.0);
  if (!start) throw TrajectoryError(o.truth + ": no pose at " + std::to_string(begin) + " s");

  // As in the report, predict with every odometry message.
  OdometryBuffer odometry(parameters.odometry);
  for (const OdometrySample& sample : excerpt.odometry) odometry.add(sample);
  const ScanPreprocessor preprocessor(parameters.scan);
  const bool is_reversed = ScanDirection(parameters.scan_direction).isReversed();
  const auto beamsOf = [&](const Scan& scan) {
    const Pose2 odom_in_base = inverse(odometry.at(scan.stamp).base_in_odom);
    return preprocessor
        .correct(preprocessor.select(scan), {parameters.range_bias.range_bias, is_reversed},
                 [&](double seconds) {
                   return compose(odom_in_base, odometry.at(scan.stamp + seconds).base_in_odom);
                 })
        .beams;
  };
  const std::unique_ptr<SensorModel> model = makeSensorModel(*map, sensorParameters(parameters));
  const MapView view = map->view();
  std::ostringstream table;
  table << std::setprecision(12) << "step,stamp,x,y,yaw\n";
  ParticleFilter filter(parameters.filter, parameters.motion, o.seed);
  filter.initialize({*start, Eigen::Matrix3d::Zero()});
  append("start", begin, filter.particles(), table);
  filter.update(beamsOf(*excerpt.first), model.get(), &view);
  append("first_scan", begin, filter.particles(), table);

  std::optional<OdometryState> last;
  for (const OdometrySample& sample : excerpt.odometry) {
    if (sample.stamp <= begin) continue;
    if (!last) last = odometry.at(begin);
    const OdometryState now = odometry.at(std::min(sample.stamp, end));
    filter.predict(motionBetween(*last, now));
    last = now;
  }
  append("moved", end, filter.particles(), table);
  filter.update(beamsOf(*excerpt.second), model.get(), &view);
  append("resampled", end, filter.particles(), table);
  writeFile(o.out, table.str());
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(argc, argv, "particle_steps",
                                 "Writes the particle sets of one filter cycle: initialized at the "
                                 "truth, after the first scan, "
                                 "after prediction by odometry, after the second scan.",
                                 racecar_mcl::addOptions, racecar_mcl::run);
}
