// A simulated car that follows the walls of a map, and the localizer that processes its sensors.
#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "racecar_mcl/localizer/localizer.h"
#include "racecar_mcl/localizer/scan_queue.h"
#include "racecar_mcl/map/map_io.h"
#include "racecar_mcl/monitoring/scan_match.h"
#include "sim/driver.h"
#include "sim/random_placement.h"
#include "sim/simulator.h"

namespace racecar_mcl {

/// A map and the finer world that belongs to it, shared by many drives.
struct Course {
  std::shared_ptr<const sim::World> world;
  std::shared_ptr<const LocalizationMap> map;
};

inline Course loadCourse(const std::string& map_path, const LocalizerParameters& parameters) {
  return {std::make_shared<const sim::World>(loadMap(sim::worldPathFor(map_path))),
          makeLocalizationMap(loadMap(map_path), parameters)};
}

/// The result of a scan and the true pose.
struct Observation {
  ScanResult result;
  int lidar = 0;       ///< Scan::lidar
  Pose2 base_in_map;   ///< true pose at the stamp of the result
  double error = 0.0;  ///< position error, m, of the odometry prediction if the scan was not used;
                       ///< +infinity without an estimate
  double inlier_ratio_from_truth = 0.0;  ///< inlier ratio of the scan at the true pose
};

class SimulatedDrive {
 public:
  SimulatedDrive(const Course& course, const LocalizerParameters& parameters,
                 const sim::SimulatorParameters& simulator, const Pose2& start, double speed,
                 std::uint64_t seed)
      : map_(course.map),
        localizer_(parameters, seed),
        simulator_(course.world, simulator, start, seed + 1000, 100.0) {
    localizer_.setMap(course.map);
    sim::WallFollowerParameters follower;
    follower.speed = speed;
    follower.car = simulator.car;
    driver_ = std::make_unique<sim::Driver>(follower);
  }

  Localizer& localizer() { return localizer_; }
  sim::Simulator& simulator() { return simulator_; }

  /// Fault injection: change a message; return false to drop it.
  std::function<bool(Scan*)> on_scan = [](Scan*) { return true; };
  std::function<bool(OdometrySample*)> on_odometry = [](OdometrySample*) { return true; };

  /// The command of each control step, instead of the wall follower's.
  std::function<sim::Command()> command;

  /// Called before each control step, such as to move obstacles.
  std::function<void(sim::Simulator*)> before_control_step = [](sim::Simulator*) {};

  /// Continues the drive and calls `visit(Observation)` after every scan.
  template <typename Visit>
  void drive(double seconds, Visit&& visit) {
    const double end = simulator_.time() + seconds;
    while (simulator_.time() < end - sim::kControlPeriod / 2.0) {
      before_control_step(&simulator_);
      const sim::Command next = command ? command() : followWall();
      for (const sim::Event& event : simulator_.advance(sim::kControlPeriod, next)) {
        if (const auto* truth = std::get_if<sim::Truth>(&event.data)) recordTruth(*truth);
        if (const auto* sample = std::get_if<OdometrySample>(&event.data)) addOdometry(*sample);
        if (const auto* sample = std::get_if<GyroSample>(&event.data)) localizer_.addGyro(*sample);
        if (const auto* sweep = std::get_if<sim::LidarScan>(&event.data)) {
          const Scan scan = sim::toScan(*sweep);
          queue_.add(scan.stamp, event.arrival, scan, scan.lidar);
        }
        const auto covers = [this](double stamp) { return localizer_.odometryCovers(stamp); };
        while (std::optional<Scan> scan = queue_.takeReady(event.arrival, covers)) {
          if (on_scan(&*scan)) visit(observe(*scan));
        }
      }
    }
  }

 private:
  sim::Command followWall() const {
    return driver_->drive(simulator_.look(), simulator_.truth().twist.vx, simulator_.collided());
  }

  void recordTruth(const sim::Truth& truth) {
    truths_.push_back(truth);
    while (truths_.size() > 100) truths_.pop_front();
  }

  void addOdometry(OdometrySample sample) {
    if (on_odometry(&sample)) localizer_.addOdometry(sample);
  }

  Pose2 truthAt(double stamp) const {
    for (std::size_t i = 1; i < truths_.size(); ++i) {
      if (truths_[i].stamp < stamp) continue;
      const double period = truths_[i].stamp - truths_[i - 1].stamp;
      return interpolate(truths_[i - 1].base_in_map, truths_[i].base_in_map,
                         (stamp - truths_[i - 1].stamp) / period);
    }
    const sim::Truth now = simulator_.truth();
    if (truths_.empty() || stamp >= now.stamp) return now.base_in_map;
    return interpolate(truths_.back().base_in_map, now.base_in_map,
                       (stamp - truths_.back().stamp) / (now.stamp - truths_.back().stamp));
  }

  /// Inlier ratio of the scan, deskewed with the true motion, at the true pose.
  double inlierRatioFromTruth(const Scan& scan) const {
    const Pose2 base_in_map = truthAt(scan.stamp);
    const ScanPreprocessor preprocessor(localizer_.parameters().scan);
    const PreprocessedScan preprocessed = preprocessor.correct(
        preprocessor.select(scan), {},
        [&](double seconds) { return between(base_in_map, truthAt(scan.stamp + seconds)); });
    return evaluateScanMatch(map_->view(), base_in_map, preprocessed.beams).inlier_ratio;
  }

  std::optional<Pose2> estimateAfter(const ScanResult& result) const {
    if (hasEstimate(result.outcome)) return result.update.estimate.base_in_map;
    const std::optional<PoseEstimate> predicted = localizer_.estimateAt(result.stamp);
    if (!predicted) return std::nullopt;
    return predicted->base_in_map;
  }

  Observation observe(const Scan& scan) {
    Observation observation;
    observation.result = localizer_.update(scan);
    observation.lidar = scan.lidar;
    observation.base_in_map = truthAt(observation.result.stamp);
    observation.error = std::numeric_limits<double>::infinity();
    if (const std::optional<Pose2> estimate = estimateAfter(observation.result)) {
      observation.error = distance(*estimate, observation.base_in_map);
    }
    observation.inlier_ratio_from_truth = inlierRatioFromTruth(scan);
    return observation;
  }

  std::shared_ptr<const LocalizationMap> map_;
  Localizer localizer_;
  sim::Simulator simulator_;
  std::unique_ptr<sim::Driver> driver_;
  std::deque<sim::Truth> truths_;
  ScanQueue<Scan> queue_;
};

}  // namespace racecar_mcl
