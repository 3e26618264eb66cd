// Tracking of obstacles over scans: Kalman filters with constant velocity and white noise
// acceleration (Bar-Shalom, Li and Kirubarajan 2001, section 6.2), and gated nearest-neighbour
// association.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/obstacles/obstacle_detection.h"

namespace racecar_mcl {

/// The noises were chosen for a car that drives ahead (bench/2026-11-29-obstacles.md).
struct ObstacleTrackerParameters {
  double position_sigma = 0.02;      ///< m, of a cluster's position, besides that due to the pose
  double acceleration_noise = 4.0;   ///< m^2/s^3, spectral density of the acceleration, per axis
  double initial_speed_sigma = 2.0;  ///< m/s, per axis, of a new track, whose velocity is 0
  double gate = 3.5;                 ///< maximum Mahalanobis distance of an association
  int confirmation_scans = 5;        ///< scans with the obstacle before its track is reported
  double timeout = 0.5;              ///< s without the obstacle before its track is deleted
};

/// A tracked obstacle, predicted to the stamp of the newest scan.
struct ObstacleTrack {
  int id = 0;                       ///< never reused by a tracker
  Eigen::Vector2d position_in_map;  ///< m
  Eigen::Vector2d velocity_in_map;  ///< m/s
  double extent = 0.0;              ///< m, of the newest cluster
  double first_stamp = 0.0;         ///< s, of the first cluster
  double last_stamp = 0.0;          ///< s, of the newest cluster
};

class ObstacleTracker {
 public:
  explicit ObstacleTracker(const ObstacleTrackerParameters& parameters = {})
      : parameters_(parameters) {}

  /// Takes the clusters of the scan with this stamp (s) and returns the confirmed tracks. If the
  /// stamp is older than the last one, all tracks are deleted.
  std::vector<ObstacleTrack> update(const std::vector<ObstacleCluster>& clusters, double stamp);

  /// Deletes all tracks.
  void clear() { tracks_.clear(); }

 private:
  struct Track {
    ObstacleTrack reported;      ///< except position and velocity
    Eigen::Vector4d state;       ///< x, y (m), and their rates (m/s), in the map
    Eigen::Matrix4d covariance;  ///< of the state
    int scans = 1;               ///< with the obstacle
  };

  Track start(const ObstacleCluster& cluster, double stamp);
  void predict(double seconds, Track* track) const;
  void correct(const ObstacleCluster& cluster, double stamp, Track* track) const;
  double squaredMahalanobis(const Track& track, const ObstacleCluster& cluster) const;
  Eigen::Matrix2d positionNoise(const ObstacleCluster& cluster) const;
  /// Corrects tracks with the clusters in their gates, the nearest pairs first. Returns for each
  /// cluster whether it was used.
  std::vector<bool> associate(const std::vector<ObstacleCluster>& clusters, double stamp);

  ObstacleTrackerParameters parameters_;
  std::vector<Track> tracks_;
  double last_stamp_ = 0.0;  ///< s
  int next_id_ = 1;
};

}  // namespace racecar_mcl
