// Learns the constants of the sensor table from recorded scans, a map and the trajectory on which
// the scans were taken.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "bag_reader.h"
#include "evaluation/sensor_fit.h"
#include "learned_config.h"
#include "parameter_options.h"
#include "program.h"
#include "racecar_mcl/map_io.h"
#include "racecar_mcl/range_caster.h"
#include "racecar_mcl/require.h"
#include "ros/node_parameters.h"

namespace racecar_mcl {
namespace {

// A car that stands sees the same again: scans count from as far apart as this.
constexpr double kNewsDistance = 0.02;  // m
constexpr double kNewsTurn = 0.02;      // rad
constexpr double kFewestBeams = 1000.0;

struct Options {
  std::vector<std::string> bags;
  std::string map;
  std::string trajectory;
  ParameterOptions parameters;
  std::string laser_pose;
  std::string scan_topic = "/scan";
  std::string base_frame = "base_link";
  double max_gap = 0.5;
  std::string out;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--bag", o->bags, "a recording; may be given several times")->required();
  app->add_option("--map", o->map, "the map's YAML file")->required();
  app->add_option("--trajectory", o->trajectory, "where base_frame was in the map: a TUM file")
      ->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--laser-pose", o->laser_pose,
                  "\"x y yaw\" of the lidar on the car, instead of the bag's tf");
  app->add_option("--scan-topic", o->scan_topic, "sensor_msgs/LaserScan")->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "the frame whose trajectory is given")
      ->capture_default_str();
  app->add_option("--max-gap", o->max_gap, "s that poses of the trajectory may lie apart")
      ->capture_default_str();
  app->add_option(
      "--out", o->out,
      "folder for sensor_model.yaml and, to plot, sensor_fit.csv [YAML to stdout only]");
}

/// Counts measured against expected ranges, scan by scan.
class Learner {
 public:
  Learner(const LocalizerParameters& parameters, const OccupancyGrid& grid, Trajectory base_in_map,
          double max_gap)
      : parameters_(parameters),
        trajectory_(std::move(base_in_map)),
        max_gap_(max_gap),
        counts_(parameters.sensor.beam, grid.geometry().resolution) {
    RangeCasterParameters caster = parameters.sensor.caster;
    caster.max_range = std::max(caster.max_range, counts_.maxRange());
    caster_ = makeRangeCaster(grid, caster);
  }

  void add(const Scan& scan, Nanoseconds stamp) {
    const std::optional<Pose2> base = poseAt(trajectory_, stamp, max_gap_);
    if (!base || !isNews(*base)) return;
    // Evenly spread, whatever the layout: what is learned is to hold for every beam.
    Scan beams = SweepOrder(parameters_.sweep_order)
                     .inOrderTaken(selectBeams(scan, parameters_.num_beams_per_particle,
                                               parameters_.scan_field_of_view));
    if (beams.size() == 0) return;
    if (parameters_.deskew) {
      const auto first = static_cast<double>(beams.seconds_after_stamp.minCoeff());
      const auto last = static_cast<double>(beams.seconds_after_stamp.maxCoeff());
      if (!poseAfter(stamp, first) || !poseAfter(stamp, last)) return;
      beams = deskew(beams, [&](double seconds) {
        return between(*base, poseAfter(stamp, seconds).value_or(*base));
      });
    }
    const Pose2 lidar = compose(*base, beams.laser_in_base);
    const PoseBatch pose{&lidar.x, &lidar.y, &lidar.yaw, 1};
    Eigen::ArrayXXf expected(beams.size(), 1);
    caster_->prepare(pose, beams.bearings);
    caster_->cast(pose, beams.bearings, expected);
    counts_.add(beams.ranges, expected.col(0));
    last_base_ = base;
    ++scans_;
  }

  const RangeCounts& counts() const { return counts_; }
  int scans() const { return scans_; }

 private:
  std::optional<Pose2> poseAfter(Nanoseconds stamp, double seconds) const {
    return poseAt(trajectory_, stamp + std::llround(seconds * 1e9), max_gap_);
  }

  bool isNews(const Pose2& base) const {
    return !last_base_ || distance(*last_base_, base) > kNewsDistance ||
           std::abs(wrapAngle(base.yaw - last_base_->yaw)) > kNewsTurn;
  }

  LocalizerParameters parameters_;
  Trajectory trajectory_;
  double max_gap_;
  RangeCounts counts_;
  std::unique_ptr<RangeCaster> caster_;
  std::optional<Pose2> last_base_;
  int scans_ = 0;
};

void countBeams(const Options& o, const BagReader& bags, const LaserMount& mount,
                const Trajectory& trajectory, Learner* learner) {
  std::size_t seen = 0, refused = 0;
  std::string refusal;
  std::optional<Nanoseconds> first, last;
  bags.forEachScan(o.scan_topic, [&](const sensor_msgs::LaserScan& message) {
    const Nanoseconds stamp = toNanoseconds(message.header.stamp);
    if (!first) first = stamp;
    last = stamp;
    ++seen;
    try {
      learner->add(toScan(message, mount), stamp);
    } catch (const MessageError& error) {
      if (refused++ == 0) refusal = error.what();
    }
  });
  if (refused > 0) {
    std::cerr << "learn_sensor_model: warning: " << refused << " of " << seen
              << " scans are not usable; the first because " << refusal << std::endl;
  }
  if (learner->counts().total() >= kFewestBeams) return;
  std::ostringstream problem;
  problem << o.trajectory << ": the trajectory " << spanOf(trajectory) << " s has poses at most "
          << "--max-gap = " << o.max_gap << " s apart for " << learner->scans() << " of " << seen
          << " scans, taken within [" << formatStamp(first.value_or(0)) << ", "
          << formatStamp(last.value_or(0)) << "] s, with " << learner->counts().total()
          << " beams; scans of a car that stands are left out; expected at least " << kFewestBeams
          << " beams";
  throw BagError(problem.str());
}

std::string yaml(const LocalizerParameters& before, const SensorFit& fit, const Learner& learner) {
  LocalizerParameters learned = before;
  SensorTableParameters& table = learned.sensor.beam.table;
  table = fit.table;
  // Of fixed digits, so that the shares still sum to 1.
  for (double* share :
       {&table.alpha_hit, &table.alpha_short, &table.alpha_max, &table.alpha_rand}) {
    *share = std::round(*share * 1e4) / 1e4;
  }
  table.sigma_hit = toFourDigits(table.sigma_hit);
  learned.sensor.sensor_model = SensorModel::kBeam;
  std::ostringstream source, quality;
  source.precision(10);
  source << "learned from " << learner.counts().total() << " beams of " << learner.scans()
         << " scans; a pixel is " << learner.counts().pixel() << " m";
  quality << "mean log-likelihood of a beam " << fit.log_likelihood << ", before "
          << fit.log_likelihood_before;
  return configText({source.str(), quality.str()}, learned,
                    {"sensor_model", "alpha_hit", "alpha_short", "alpha_max", "alpha_rand",
                     "sigma_hit", "table_width"});
}

/// Adds rows for the beams with an expected range in [from, to): the shares measured at each range,
/// and what both tables expect of the same beams.
void addBand(const RangeCounts& beams, const Eigen::ArrayXXd& learned,
             const Eigen::ArrayXXd& before, Eigen::Index from, Eigen::Index to, std::ostream* csv) {
  const double total = beams.counts().middleCols(from, to - from).sum();
  const auto weighted = [&](const Eigen::ArrayXXd& table, Eigen::Index z) {
    double sum = 0.0;
    for (Eigen::Index d = from; d < to; ++d) sum += table(z, d) * beams.counts().col(d).sum();
    return sum / total;
  };
  for (Eigen::Index z = 0; z < beams.counts().rows(); ++z) {
    *csv << static_cast<double>(from) * beams.pixel() << ','
         << static_cast<double>(to - 1) * beams.pixel() << ','
         << static_cast<double>(z) * beams.pixel() << ','
         << beams.counts().row(z).segment(from, to - from).sum() / total << ','
         << weighted(learned, z) << ',' << weighted(before, z) << '\n';
  }
}

/// Four narrow bands, each about the expected range that is most common in a quarter of the beams.
std::string csv(const RangeCounts& beams, const SensorFit& fit,
                const SensorTableParameters& before) {
  std::ostringstream text;
  text.precision(8);
  text << "expected_from,expected_to,range,measured,learned,before\n";
  const Eigen::ArrayXXd learned_table = makeSensorTable(fit.table);
  const Eigen::ArrayXXd before_table = makeSensorTable(before);
  const Eigen::ArrayXd columns = beams.counts().colwise().sum().transpose();
  constexpr int kBands = 4;
  double passed = 0.0;
  Eigen::Index begin = 0;
  for (int band = 1; band <= kBands; ++band) {
    Eigen::Index end = begin;
    while (end < columns.size() && passed < columns.sum() * band / kBands) passed += columns[end++];
    if (end == begin) continue;
    Eigen::Index most = 0;
    columns.segment(begin, end - begin).maxCoeff(&most);
    most += begin;
    addBand(beams, learned_table, before_table, std::max(begin, most - 1), std::min(end, most + 2),
            &text);
    begin = end;
  }
  return text.str();
}

void learn(const Options& o) {
  requirePositive("--max-gap", o.max_gap, "s");
  const LocalizerParameters parameters = readParameters(o.parameters);
  validate(parameters);
  const OccupancyGrid grid = loadMap(o.map);
  const Trajectory trajectory = readTum(o.trajectory);
  const BagReader bags(o.bags);
  bags.requireTopic(o.scan_topic, "sensor_msgs/LaserScan", "--scan-topic");
  const LaserMount mount = o.laser_pose.empty()
                               ? bags.laserMount(o.scan_topic, o.base_frame)
                               : LaserMount{parsePose("--laser-pose", o.laser_pose), false};

  Learner learner(parameters, grid, trajectory, o.max_gap);
  countBeams(o, bags, mount, trajectory, &learner);
  const SensorTableParameters& before = parameters.sensor.beam.table;
  const SensorFit fit = fitSensorTable(learner.counts().counts(), before);
  writeLearned(o.out, {"sensor_model.yaml", yaml(parameters, fit, learner)},
               {"sensor_fit.csv", csv(learner.counts(), fit, before)});
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "learn_sensor_model",
      "Learns the constants of the sensor table and prints them as a configuration.",
      racecar_mcl::addOptions, racecar_mcl::learn);
}
