// Estimates the beam model's parameters from recorded scans, a map and the trajectory of the
// recording.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "calibration/beam_model_estimation.h"
#include "calibration_output.h"
#include "cli.h"
#include "file_options.h"
#include "lidar_options.h"
#include "offline/bag_reader.h"
#include "parameter_options.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/map/map_io.h"
#include "racecar_mcl/raycasting/range_caster.h"

namespace racecar_mcl {
namespace {

// Minimum motion between used scans: scans of a stationary car are redundant.
constexpr double kMinDistance = 0.02;  // m
constexpr double kMinRotation = 0.02;  // rad
constexpr double kMinBeams = 1000.0;

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
  app->add_option("--bag", o->bags, "recorded bag; may be repeated")->required();
  app->add_option("--map", o->map, "map YAML file")->required();
  app->add_option("--trajectory", o->trajectory, "trajectory of base_frame in the map, a TUM file")
      ->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--laser-pose", o->laser_pose,
                  "\"x y yaw\" of the lidar in base_frame, instead of the bag's tf");
  app->add_option("--scan-topic", o->scan_topic, "sensor_msgs/LaserScan")->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "frame of the trajectory")->capture_default_str();
  app->add_option("--max-gap", o->max_gap, "maximum interval between trajectory poses, s")
      ->capture_default_str();
  app->add_option(
      "--out", o->out,
      "output folder for beam_model.yaml and beam_model.csv (for plots) [print YAML only]");
}

/// Histogram of measured and expected ranges over all scans.
class BeamCounter {
 public:
  BeamCounter(const LocalizerParameters& parameters, const OccupancyGrid& grid,
              Trajectory base_in_map, double max_gap)
      : preprocessor_(withEvenBeams(parameters.scan)),
        direction_(parameters.scan_direction),
        trajectory_(std::move(base_in_map)),
        max_gap_(max_gap),
        counts_(parameters.sensor.beam, grid.geometry().resolution) {
    RangeCasterParameters caster = parameters.sensor.caster;
    caster.max_range = std::max(caster.max_range, counts_.maxRange());
    caster_ = makeRangeCaster(grid, caster);
  }

  void add(const Scan& scan, Nanoseconds stamp) {
    const std::optional<Pose2> base = poseAt(trajectory_, stamp, max_gap_);
    if (!base || !hasMoved(*base)) return;
    Scan selected = preprocessor_.select(scan);
    if (selected.size() == 0) return;
    bool is_covered = true;
    const Scan beams = preprocessor_
                           .correct(std::move(selected), {0.0, direction_.isReversed()},
                                    [&](double seconds) {
                                      const std::optional<Pose2> later = poseAfter(stamp, seconds);
                                      is_covered = is_covered && later;
                                      return between(*base, later.value_or(*base));
                                    })
                           .beams;
    if (!is_covered) return;
    const Pose2 lidar = compose(*base, beams.laser_in_base);
    Eigen::ArrayXXf expected(beams.size(), 1);
    caster_->cast(batchOf(lidar), beams.bearings, expected);
    counts_.add(beams.ranges, expected.col(0));
    last_base_ = base;
    ++scans_;
  }

  const RangeCounts& counts() const { return counts_; }
  int scans() const { return scans_; }

 private:
  std::optional<Pose2> poseAfter(Nanoseconds stamp, double seconds) const {
    return poseAt(trajectory_, stamp + toNanoseconds(seconds), max_gap_);
  }

  bool hasMoved(const Pose2& base) const {
    return !last_base_ || distance(*last_base_, base) > kMinDistance ||
           std::abs(wrapAngle(base.yaw - last_base_->yaw)) > kMinRotation;
  }

  /// Evenly spaced beams, so that the estimate represents all beams.
  static ScanParameters withEvenBeams(ScanParameters parameters) {
    parameters.beam_layout = BeamLayout::kEven;
    return parameters;
  }

  ScanPreprocessor preprocessor_;
  ScanDirection direction_;
  Trajectory trajectory_;
  double max_gap_;
  RangeCounts counts_;
  std::unique_ptr<RangeCaster> caster_;
  std::optional<Pose2> last_base_;
  int scans_ = 0;
};

void countBeams(const Options& o, const BagReader& bags, const LidarExtrinsics& extrinsics,
                const Trajectory& trajectory, BeamCounter* beam_counter) {
  std::size_t seen = 0, rejected = 0;
  std::string reason;
  std::optional<Nanoseconds> first, last;
  bags.forEachScan(o.scan_topic, [&](const sensor_msgs::LaserScan& message) {
    const Nanoseconds stamp = toNanoseconds(message.header.stamp);
    if (!first) first = stamp;
    last = stamp;
    ++seen;
    try {
      beam_counter->add(toScan(message, extrinsics), stamp);
    } catch (const MessageError& error) {
      if (rejected++ == 0) reason = error.what();
    }
  });
  if (rejected > 0) {
    std::cerr << "calibrate_beam_model: warning: rejected " << rejected << " of " << seen
              << " scans; first reason: " << reason << std::endl;
  }
  if (beam_counter->counts().total() >= kMinBeams) return;
  std::ostringstream problem;
  problem << o.trajectory << ": trajectory " << spanOf(trajectory) << " s, scans ["
          << formatStamp(first.value_or(0)) << ", " << formatStamp(last.value_or(0))
          << "] s: " << beam_counter->scans() << " of " << seen << " scans with "
          << beam_counter->counts().total() << " beams are usable; expected at least " << kMinBeams
          << " beams of a moving car, with poses at most --max-gap = " << o.max_gap << " s apart";
  throw BagError(problem.str());
}

std::string yaml(const LocalizerParameters& before, const BeamModelEstimate& estimate,
                 const BeamCounter& beam_counter) {
  LocalizerParameters estimated = before;
  BeamTableParameters& table = estimated.sensor.beam.table;
  table = estimate.table;
  // Fixed decimals, so that the weights still sum to 1.
  for (double* weight :
       {&table.alpha_hit, &table.alpha_short, &table.alpha_max, &table.alpha_rand}) {
    *weight = std::round(*weight * 1e4) / 1e4;
  }
  table.sigma_hit = toFourDigits(table.sigma_hit);
  estimated.sensor.sensor_model = SensorModelType::kBeam;
  std::ostringstream source, quality;
  source.precision(10);
  source << "estimated from " << beam_counter.counts().total() << " beams of "
         << beam_counter.scans() << " scans; a pixel is " << beam_counter.counts().pixel() << " m";
  quality << "mean log-likelihood per beam " << estimate.log_likelihood << ", before "
          << estimate.log_likelihood_before;
  return configText({source.str(), quality.str()}, estimated,
                    {"sensor_model", "alpha_hit", "alpha_short", "alpha_max", "alpha_rand",
                     "sigma_hit", "expert/table_width"});
}

/// Adds rows for the beams with an expected range in [from, to): measured fraction per range, and
/// the fractions predicted by both tables.
void addBand(const RangeCounts& beams, const Eigen::ArrayXXd& estimated,
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
         << weighted(estimated, z) << ',' << weighted(before, z) << '\n';
  }
}

/// Four narrow bands, each around the most common expected range of a quarter of the beams.
std::string csv(const RangeCounts& beams, const BeamModelEstimate& estimate,
                const BeamTableParameters& before) {
  std::ostringstream text;
  text.precision(8);
  text << "expected_from,expected_to,range,measured,estimated,before\n";
  const Eigen::ArrayXXd estimated_table = makeBeamTable(estimate.table);
  const Eigen::ArrayXXd before_table = makeBeamTable(before);
  const Eigen::ArrayXd columns = beams.counts().colwise().sum().transpose();
  constexpr int kBands = 4;
  double passed = 0.0;
  Eigen::Index begin = 0;
  for (int band = 1; band <= kBands; ++band) {
    Eigen::Index end = begin;
    while (end < columns.size() && passed < columns.sum() * band / kBands) passed += columns[end++];
    if (end == begin) continue;
    Eigen::Index peak = 0;
    columns.segment(begin, end - begin).maxCoeff(&peak);
    peak += begin;
    addBand(beams, estimated_table, before_table, std::max(begin, peak - 1),
            std::min(end, peak + 2), &text);
    begin = end;
  }
  return text.str();
}

void calibrate(const Options& o) {
  requirePositive("--max-gap", o.max_gap, "s");
  std::vector<std::string> inputs = mapFiles(o.map);
  inputs.insert(inputs.end(), o.bags.begin(), o.bags.end());
  inputs.insert(inputs.end(), {o.trajectory, o.parameters.config});
  requireSeparateFiles(filesIn(o.out, {"beam_model.yaml", "beam_model.csv"}), inputs);
  const LocalizerParameters parameters = readParameters(o.parameters);
  validate(parameters);
  const OccupancyGrid grid = loadMap(o.map);
  const Trajectory trajectory = readTum(o.trajectory);
  const BagReader bags(o.bags);
  bags.requireTopic(o.scan_topic, "sensor_msgs/LaserScan", "--scan-topic");
  const LidarExtrinsics extrinsics =
      lidarExtrinsics(o.laser_pose, bags, o.scan_topic, o.base_frame);

  BeamCounter beam_counter(parameters, grid, trajectory, o.max_gap);
  countBeams(o, bags, extrinsics, trajectory, &beam_counter);
  const BeamTableParameters& before = parameters.sensor.beam.table;
  const BeamModelEstimate estimate = estimateBeamModel(beam_counter.counts().counts(), before);
  writeCalibration(o.out, {"beam_model.yaml", yaml(parameters, estimate, beam_counter)},
                   {"beam_model.csv", csv(beam_counter.counts(), estimate, before)});
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "calibrate_beam_model",
      "Estimates the beam model's parameters and prints them as a configuration.",
      racecar_mcl::addOptions, racecar_mcl::calibrate);
}
