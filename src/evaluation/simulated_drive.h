// A simulated car that drives along the walls of one of the package's maps, and the localizer that
// hears its sensors.
#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "racecar_mcl/localizer.h"
#include "racecar_mcl/map_io.h"
#include "racecar_mcl/scan_fit.h"
#include "racecar_mcl/scan_hold.h"
#include "sim/driver.h"
#include "sim/placement.h"
#include "sim/simulator.h"

namespace racecar_mcl {

/// A map of maps/ and the finer world behind it, shared by many drives.
struct Course {
  std::shared_ptr<const sim::World> world;
  std::shared_ptr<MapModel> map;
};

inline Course loadCourse(const std::string& map_path, const LocalizerParameters& parameters) {
  return {std::make_shared<const sim::World>(loadMap(sim::worldPathFor(map_path))),
          makeMapModel(loadMap(map_path), parameters)};
}

/// What a localizer made of a scan, and what was true.
struct Observation {
  ScanResult result;
  Pose2 base_in_map;   ///< true, at the scan's stamp
  double error = 0.0;  ///< m, of the estimate, carried on by odometry where the scan was not used;
                       ///< +infinity where there is none
  double explained_from_truth = 0.0;  ///< share of the beams that the map explains, seen from where
                                      ///< the car truly was
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

  /// What befalls messages on their way; false drops one. By default nothing does.
  std::function<bool(Scan*)> on_scan = [](Scan*) { return true; };
  std::function<bool(OdometrySample*)> on_odometry = [](OdometrySample*) { return true; };

  /// What happens in the world before each look of the driver. By default nothing does.
  std::function<void(sim::Simulator*)> before_look = [](sim::Simulator*) {};

  /// Drives on, and calls `visit(Observation)` after every scan.
  template <typename Visit>
  void drive(double seconds, Visit&& visit) {
    const double end = simulator_.time() + seconds;
    while (simulator_.time() < end - kDriverPeriod / 2.0) {
      before_look(&simulator_);
      const double speed = simulator_.truth().twist.vx;
      const sim::Command command = driver_->drive(simulator_.look(), speed, simulator_.collided());
      for (const sim::Event& event : simulator_.advance(kDriverPeriod, command)) {
        if (const auto* truth = std::get_if<sim::Truth>(&event.data)) remember(*truth);
        if (const auto* sample = std::get_if<OdometrySample>(&event.data)) hear(*sample);
        if (const auto* sweep = std::get_if<sim::LidarScan>(&event.data)) {
          const Scan scan = sim::toScan(*sweep);
          hold_.add(scan.stamp, event.arrival, scan);
        }
        const auto covers = [this](double stamp) { return localizer_.odometryCovers(stamp); };
        while (std::optional<Scan> scan = hold_.takeReady(event.arrival, covers)) {
          if (on_scan(&*scan)) visit(observe(*scan));
        }
      }
    }
  }

 private:
  static constexpr double kDriverPeriod = 0.02;  // s, between the driver's looks

  void remember(const sim::Truth& truth) {
    truths_.push_back(truth);
    while (truths_.size() > 100) truths_.pop_front();
  }

  void hear(OdometrySample sample) {
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

  /// The share of the scan's beams that the map explains from where each was truly taken.
  double explainedFromTruth(const Scan& scan) const {
    const Pose2 base_in_map = truthAt(scan.stamp);
    const Scan beams = chooseBeams(localizer_.parameters(), scan);
    const Scan straight = deskew(
        beams, [&](double seconds) { return between(base_in_map, truthAt(scan.stamp + seconds)); });
    return fitScan(map_.get(), base_in_map, straight).explained;
  }

  std::optional<Pose2> estimateAfter(const ScanResult& result) const {
    if (leavesEstimate(result.outcome)) return result.update.estimate.base_in_map;
    const std::optional<PoseEstimate> carried = localizer_.estimateAt(result.stamp);
    if (!carried) return std::nullopt;
    return carried->base_in_map;
  }

  Observation observe(const Scan& scan) {
    Observation observation;
    observation.result = localizer_.addScan(scan);
    observation.base_in_map = truthAt(scan.stamp);
    observation.error = std::numeric_limits<double>::infinity();
    if (const std::optional<Pose2> estimate = estimateAfter(observation.result)) {
      observation.error = distance(*estimate, observation.base_in_map);
    }
    observation.explained_from_truth = explainedFromTruth(scan);
    return observation;
  }

  std::shared_ptr<MapModel> map_;
  Localizer localizer_;
  sim::Simulator simulator_;
  std::unique_ptr<sim::Driver> driver_;
  std::deque<sim::Truth> truths_;
  ScanHold<Scan> hold_;
};

}  // namespace racecar_mcl
