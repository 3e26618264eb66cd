// One round of the particle filter, step by step: the sets that the report's figures 2 and 3 show.
#include <fstream>
#include <iomanip>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "bag_reader.h"
#include "evaluation/trajectory.h"
#include "output_files.h"
#include "parameter_options.h"
#include "program.h"
#include "racecar_mcl/errors.h"
#include "racecar_mcl/localizer.h"
#include "racecar_mcl/map_io.h"
#include "racecar_mcl/parameters.h"
#include "racecar_mcl/particle_filter.h"

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
  app->add_option("--bag", o->bag, "a recording")->required();
  app->add_option("--map", o->map, "the map's YAML file")->required();
  app->add_option("--truth", o->truth, "the true trajectory, a TUM file")->required();
  app->add_option("--out", o->out, "the CSV file to write")->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--at", o->at, "s after the truth's beginning: start with the next scan")
      ->capture_default_str();
  app->add_option("--drive", o->drive, "s to drive by odometry alone")->capture_default_str();
  app->add_option("--seed", o->seed, "of every random number")->capture_default_str();
  app->add_option("--scan-topic", o->scan_topic, "sensor_msgs/LaserScan")->capture_default_str();
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "the frame that is localized")
      ->capture_default_str();
}

/// What the round needs of the recording: odometry, and a scan at its beginning and at its end.
struct Excerpt {
  std::vector<OdometrySample> odometry;  ///< from the first scan to the second
  std::optional<Scan> first;
  std::optional<Scan> second;
};

Excerpt readExcerpt(const BagReader& bag, const Options& o, double begin) {
  const LaserMount mount = bag.laserMount(o.scan_topic, o.base_frame);
  Excerpt excerpt;
  bag.forEach(o.scan_topic, o.odom_topic, [&](const BagEvent& event) {
    if (excerpt.second) return;
    if (event.odometry) {
      excerpt.odometry.push_back(toOdometrySample(*event.odometry));
    } else if (event.scan->header.stamp.toSec() >= begin && !excerpt.first) {
      excerpt.first = toScan(*event.scan, mount);
    } else if (excerpt.first &&
               event.scan->header.stamp.toSec() >= excerpt.first->stamp + o.drive) {
      excerpt.second = toScan(*event.scan, mount);
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
  LocalizerParameters parameters = readParameters(o.parameters);
  // Every step bare: the set that was weighed is drawn anew at once, and not smoothed.
  parameters.filter.resample_threshold = 1.0;
  parameters.filter.settling_updates = 0;
  validate(parameters);
  const std::shared_ptr<MapModel> map = makeMapModel(loadMap(o.map), parameters);
  const Trajectory truth = readTum(o.truth);
  const BagReader bag({o.bag});
  bag.requireTopic(o.scan_topic, "sensor_msgs/LaserScan", "--scan-topic");
  bag.requireTopic(o.odom_topic, "nav_msgs/Odometry", "--odom-topic");
  const Excerpt excerpt = readExcerpt(bag, o, toSeconds(truth.front().stamp) + o.at);
  const double begin = excerpt.first->stamp, end = excerpt.second->stamp;
  const std::optional<Pose2> start =
      poseAt(truth, static_cast<Nanoseconds>(std::llround(begin * 1e9)), 1.0);
  if (!start) throw TrajectoryError(o.truth + ": tells no pose at " + std::to_string(begin) + " s");

  const auto beamsOf = [&](const Scan& scan) { return chooseBeams(parameters, scan); };
  std::ostringstream table;
  table << std::setprecision(12) << "step,stamp,x,y,yaw\n";
  ParticleFilter filter(parameters.filter, parameters.motion, o.seed);
  filter.initialize({*start, Eigen::Matrix3d::Zero()});
  append("start", begin, filter.particles(), table);
  filter.update(map.get(), beamsOf(*excerpt.first));
  append("first_scan", begin, filter.particles(), table);

  // The report moves the particles with every odometry message.
  OdometryHistory odometry(parameters.odometry);
  std::optional<OdometryState> last;
  for (const OdometrySample& sample : excerpt.odometry) {
    odometry.add(sample);
    if (sample.stamp <= begin) continue;
    if (!last) last = odometry.at(begin);
    const OdometryState now = odometry.at(std::min(sample.stamp, end));
    filter.predict(motionBetween(*last, now));
    last = now;
  }
  append("moved", end, filter.particles(), table);
  filter.update(map.get(), beamsOf(*excerpt.second));
  append("resampled", end, filter.particles(), table);
  writeFile(o.out, table.str());
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "particle_steps",
      "Writes the particle sets of one round of the filter: as started about the truth, "
      "after the first scan, after driving by odometry alone, after the next scan.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
