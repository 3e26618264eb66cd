// Obstacles found on simulated drives, compared with the true ones.
#pragma once

#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "offline/obstacle_truth.h"
#include "offline/simulated_drive.h"
#include "racecar_mcl/localizer/obstacle_observer.h"

namespace racecar_mcl {

/// Sums over scans. A return belongs to an obstacle if it is within 0.15 m of it.
struct ObstacleScore {
  int scans = 0;                         ///< with an estimate
  int visible = 0;                       ///< true obstacles in view, counted in each scan
  int found = 0;                         ///< of these, with a detected return
  int clusters = 0;                      ///< detected
  int false_clusters = 0;                ///< of these, without a return that belongs to an obstacle
  int settled = 0;                       ///< true obstacles that have been in view for 0.5 s
  int velocities = 0;                    ///< of these, with a track that was seen in the scan
  double squared_velocity_errors = 0.0;  ///< m^2/s^2

  double recall() const { return visible > 0 ? static_cast<double>(found) / visible : 1.0; }
  /// m/s, root mean square of the distances between estimated and true velocity.
  double velocityRms() const {
    return velocities > 0 ? std::sqrt(squared_velocity_errors / velocities) : 0.0;
  }
  ObstacleScore& operator+=(const ObstacleScore& other) {
    scans += other.scans;
    visible += other.visible;
    found += other.found;
    clusters += other.clusters;
    false_clusters += other.false_clusters;
    settled += other.settled;
    velocities += other.velocities;
    squared_velocity_errors += other.squared_velocity_errors;
    return *this;
  }
};

/// Runs an ObstacleObserver on a drive.
class ObstacleEvaluation {
 public:
  /// Replaces the drive's on_scan and extends its before_control_step. The drive must outlive it.
  ObstacleEvaluation(std::shared_ptr<const sim::World> world,
                     const ObstacleDetectionParameters& parameters, SimulatedDrive* drive)
      : world_(std::move(world)), observer_(parameters), drive_(drive) {
    drive->on_scan = [this](Scan* scan) {
      scan_ = *scan;
      return true;
    };
    drive->before_control_step = [this,
                                  others = drive->before_control_step](sim::Simulator* simulator) {
      others(simulator);
      history_.add(*simulator);
    };
  }
  ObstacleEvaluation(const ObstacleEvaluation&) = delete;
  ObstacleEvaluation& operator=(const ObstacleEvaluation&) = delete;

  /// Call it with every observation of the drive.
  void add(const Observation& seen) {
    if (!hasEstimate(seen.result.outcome)) return;
    const DetectedObstacles detected = observer_.detect(drive_->localizer(), scan_, seen.result);
    const std::vector<ObstacleTrack> tracks = observer_.track(detected, seen.result);
    const std::vector<sim::Obstacle> obstacles = history_.at(scan_.stamp);
    ++score_.scans;
    countClusters(detected, obstacles);
    const sim::LidarParameters& lidar = drive_->simulator().parameters().lidar;
    const std::vector<bool> in_view =
        obstaclesInView(obstacles, *world_, lidar, compose(seen.base_in_map, lidar.laser_in_base));
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      if (!in_view[i]) {
        in_view_since_.erase(i);
        continue;
      }
      ++score_.visible;
      score_.found += hasPoint(obstacles[i], detected.points_in_map) ? 1 : 0;
      const double since = in_view_since_.emplace(i, scan_.stamp).first->second;
      if (scan_.stamp - since >= kSettlingTime) addVelocity(i, obstacles[i], tracks);
    }
    compareVelocities();
  }

  const ObstacleScore& score() const { return score_; }

 private:
  static constexpr double kMaxDistance = 0.15;  // m
  static constexpr double kSettlingTime = 0.5;  // s

  /// A track's velocity, to be compared once the true one is known.
  struct TrackedVelocity {
    double stamp = 0.0;  ///< s
    std::size_t obstacle = 0;
    Eigen::Vector2d in_map;  ///< m/s
  };

  static bool hasPoint(const sim::Obstacle& obstacle,
                       const Eigen::Ref<const Eigen::Matrix2Xd>& points) {
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      if (distanceTo(obstacle, points.col(k)) < kMaxDistance) return true;
    }
    return false;
  }

  void countClusters(const DetectedObstacles& detected,
                     const std::vector<sim::Obstacle>& obstacles) {
    Eigen::Index first = 0;
    for (const ObstacleCluster& cluster : detected.clusters) {
      const auto points = detected.points_in_map.middleCols(first, cluster.returns);
      first += cluster.returns;
      const bool is_true =
          std::any_of(obstacles.begin(), obstacles.end(),
                      [&](const sim::Obstacle& obstacle) { return hasPoint(obstacle, points); });
      ++score_.clusters;
      score_.false_clusters += is_true ? 0 : 1;
    }
  }

  /// The velocity of the oldest track of an obstacle, if there is one.
  void addVelocity(std::size_t index, const sim::Obstacle& obstacle,
                   const std::vector<ObstacleTrack>& tracks) {
    ++score_.settled;
    const ObstacleTrack* oldest = nullptr;
    for (const ObstacleTrack& track : tracks) {
      const bool is_seen = track.last_stamp == scan_.stamp;
      if (!is_seen || distanceTo(obstacle, track.position_in_map) > kMaxDistance) continue;
      if (oldest == nullptr || track.first_stamp < oldest->first_stamp) oldest = &track;
    }
    if (oldest != nullptr) velocities_.push_back({scan_.stamp, index, oldest->velocity_in_map});
  }

  void compareVelocities() {
    while (!velocities_.empty() && history_.covers(velocities_.front().stamp)) {
      const TrackedVelocity& tracked = velocities_.front();
      const Eigen::Vector2d truth = history_.velocity(tracked.obstacle, tracked.stamp);
      ++score_.velocities;
      score_.squared_velocity_errors += (tracked.in_map - truth).squaredNorm();
      velocities_.pop_front();
    }
  }

  std::shared_ptr<const sim::World> world_;
  ObstacleObserver observer_;
  SimulatedDrive* drive_;
  Scan scan_;  ///< the newest
  ObstacleHistory history_;
  std::map<std::size_t, double> in_view_since_;  ///< s, by obstacle
  std::deque<TrackedVelocity> velocities_;
  ObstacleScore score_;
};

}  // namespace racecar_mcl
