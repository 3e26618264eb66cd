// Laps of a simulated car that a pure-pursuit driver steers along a raceline, on the estimate of a
// localizer or on the true pose.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "evaluation/race_evaluation.h"
#include "offline/fault_injection.h"
#include "offline/obstacle_truth.h"
#include "offline/race_track.h"
#include "sim/pure_pursuit.h"

namespace racecar_mcl {

constexpr double kOpponentMargin = 0.4;  // m, at 7.6 m/s it moves by 0.3 m until a scan arrives

/// The laps of one drive along a raceline.
class RaceRecorder {
 public:
  explicit RaceRecorder(const sim::Raceline& raceline)
      : raceline_(raceline), timer_(raceline.length()) {}

  /// At every control step; `estimate`: that the car is driven on.
  void update(const sim::Truth& truth, const Pose2& estimate) {
    const sim::Raceline::Place place =
        raceline_.placeOf({truth.base_in_map.x, truth.base_in_map.y});
    timer_.update(place.along, truth.stamp);
    if (laps() < 1) return;
    score.lateral.add(std::abs(place.lateral));
    score.addEstimate(estimate, truth.base_in_map);
    score.max_speed = std::max(score.max_speed, truth.twist.vx);
  }

  int laps() const { return timer_.laps(); }

  /// Calls `step`, which simulates a control step, until all laps are complete, or for at most
  /// twice the time that they take at the lowest speed of the profile.
  template <typename Step>
  RaceScore drive(int evaluated_laps, Step step) {
    const double slowest_lap = raceline_.length() / raceline_.minSpeed();
    const auto max_steps =
        std::lround(2.0 * (evaluated_laps + 1) * slowest_lap / sim::kControlPeriod);
    for (long i = 0; i < max_steps && laps() <= evaluated_laps; ++i) step();
    score.lap_times = timer_.lapTimes();
    return score;
  }

  RaceScore score;

 private:
  sim::Raceline raceline_;
  LapTimer timer_;
};

/// Whether a return at this point of the map is from one of the obstacles.
inline bool isNear(const std::vector<sim::Obstacle>& obstacles, const Eigen::Vector2d& point) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const sim::Obstacle& obstacle) {
    return distanceTo(obstacle, point) < kOpponentMargin;
  });
}

/// Drives on the true pose, without a localizer. An opponent would change nothing.
inline RaceScore raceOnTruth(const RaceTrack& track, const RaceSettings& settings) {
  const sim::PurePursuit driver(racelineOf(track, settings), {});
  sim::SimulatorParameters parameters;
  parameters.lidar.beams = 2;  // unused
  sim::Simulator simulator(track.course.world, parameters, driver.raceline().poseAt(0.0), 0);
  RaceRecorder recorder(driver.raceline());
  return recorder.drive(settings.laps, [&] {
    const sim::Truth truth = simulator.truth();
    recorder.update(truth, truth.base_in_map);
    simulator.advance(sim::kControlPeriod, driver.drive(truth.base_in_map));
    recorder.score.collisions = simulator.collisions();
  });
}

/// Drives on the estimate at the time of each control step. Without one the car stops.
inline RaceScore raceOnEstimate(const RaceTrack& track, const LocalizerParameters& parameters,
                                const RaceSettings& settings) {
  const sim::PurePursuit driver(racelineOf(track, settings), {});
  const Pose2 start = driver.raceline().poseAt(0.0);
  sim::SimulatorParameters simulated;
  simulated.odometry.slip = settings.grip.slip;
  SimulatedDrive drive(track.course, parameters, simulated, start, settings.max_speed,
                       settings.seed);
  Random random(settings.seed);
  placeObstacles(settings.has_opponent ? Fault::kOpponent : Fault::kNone, track.course, {},
                 settings.seed, random, &drive);
  drive.localizer().initialize(startAt(start));

  RaceRecorder recorder(driver.raceline());
  drive.command = [&]() -> sim::Command {
    const sim::Truth truth = drive.simulator().truth();
    const std::optional<PoseEstimate> estimate = drive.localizer().estimateAt(truth.stamp);
    if (!estimate) return {};
    recorder.update(truth, estimate->base_in_map);
    return driver.drive(estimate->base_in_map);
  };
  Scan scan;
  drive.on_scan = [&](Scan* newest) {
    scan = *newest;
    return true;
  };
  const BoundsMatch bounds(track.course.map->grid);
  const auto is_opponent = [&](const Eigen::Vector2d& point) {
    return isNear(drive.simulator().obstacles(), point);
  };
  return recorder.drive(settings.laps, [&] {
    drive.drive(sim::kControlPeriod, [&](const Observation& seen) {
      if (recorder.laps() < 1 || !hasEstimate(seen.result.outcome)) return;
      const Pose2& estimate = seen.result.update.estimate.base_in_map;
      recorder.score.addStatus(seen.result.status, estimate, seen.base_in_map);
      const Scan deskewed = drive.localizer().correctedScan(scan, static_cast<int>(scan.size()));
      bounds.add(deskewed, estimate, is_opponent, &recorder.score);
    });
    recorder.score.collisions = drive.simulator().collisions();
  });
}

}  // namespace racecar_mcl
