#include "racecar_mcl/obstacles/obstacle_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <tuple>

namespace racecar_mcl {

std::vector<ObstacleTrack> ObstacleTracker::update(const std::vector<ObstacleCluster>& clusters,
                                                   double stamp) {
  if (stamp < last_stamp_) tracks_.clear();
  const auto is_old = [&](const Track& track) {
    return stamp - track.reported.last_stamp > parameters_.timeout;
  };
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), is_old), tracks_.end());
  for (Track& track : tracks_) predict(stamp - last_stamp_, &track);
  last_stamp_ = stamp;
  const std::vector<bool> is_tracked = associate(clusters, stamp);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (!is_tracked[c]) tracks_.push_back(start(clusters[c], stamp));
  }
  std::vector<ObstacleTrack> confirmed;
  for (const Track& track : tracks_) {
    if (track.scans < parameters_.confirmation_scans) continue;
    confirmed.push_back(track.reported);
    confirmed.back().position_in_map = track.state.head<2>();
    confirmed.back().velocity_in_map = track.state.tail<2>();
  }
  return confirmed;
}

ObstacleTracker::Track ObstacleTracker::start(const ObstacleCluster& cluster, double stamp) {
  Track track;
  track.reported.id = next_id_++;
  track.reported.extent = cluster.extent;
  track.reported.first_stamp = track.reported.last_stamp = stamp;
  track.state << cluster.position_in_map, Eigen::Vector2d::Zero();
  track.covariance.setZero();
  track.covariance.topLeftCorner<2, 2>() = positionNoise(cluster);
  track.covariance.bottomRightCorner<2, 2>().diagonal().setConstant(
      parameters_.initial_speed_sigma * parameters_.initial_speed_sigma);
  return track;
}

void ObstacleTracker::predict(double seconds, Track* track) const {
  Eigen::Matrix4d transition = Eigen::Matrix4d::Identity();
  transition.topRightCorner<2, 2>().diagonal().setConstant(seconds);
  // White noise acceleration with the spectral density q, per axis:
  // q (T^3 / 3, T^2 / 2; T^2 / 2, T).
  const double q = parameters_.acceleration_noise;
  Eigen::Matrix4d noise = Eigen::Matrix4d::Zero();
  noise.topLeftCorner<2, 2>().diagonal().setConstant(q * seconds * seconds * seconds / 3.0);
  noise.topRightCorner<2, 2>().diagonal().setConstant(q * seconds * seconds / 2.0);
  noise.bottomLeftCorner<2, 2>().diagonal().setConstant(q * seconds * seconds / 2.0);
  noise.bottomRightCorner<2, 2>().diagonal().setConstant(q * seconds);
  track->state = transition * track->state;
  track->covariance = transition * track->covariance * transition.transpose() + noise;
}

Eigen::Matrix2d ObstacleTracker::positionNoise(const ObstacleCluster& cluster) const {
  const double variance = parameters_.position_sigma * parameters_.position_sigma;
  return cluster.covariance + variance * Eigen::Matrix2d::Identity();
}

double ObstacleTracker::squaredMahalanobis(const Track& track,
                                           const ObstacleCluster& cluster) const {
  const Eigen::Vector2d innovation = cluster.position_in_map - track.state.head<2>();
  const Eigen::Matrix2d covariance =
      track.covariance.topLeftCorner<2, 2>() + positionNoise(cluster);
  return innovation.dot(covariance.inverse() * innovation);
}

std::vector<bool> ObstacleTracker::associate(const std::vector<ObstacleCluster>& clusters,
                                             double stamp) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;  // distance, track, cluster
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      const double squared = squaredMahalanobis(tracks_[t], clusters[c]);
      if (squared <= parameters_.gate * parameters_.gate) pairs.emplace_back(squared, t, c);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> is_updated(tracks_.size(), false);
  std::vector<bool> is_tracked(clusters.size(), false);
  for (const auto& [squared, t, c] : pairs) {
    if (is_updated[t] || is_tracked[c]) continue;
    is_updated[t] = is_tracked[c] = true;
    correct(clusters[c], stamp, &tracks_[t]);
  }
  return is_tracked;
}

void ObstacleTracker::correct(const ObstacleCluster& cluster, double stamp, Track* track) const {
  const Eigen::Matrix2d innovation_covariance =
      track->covariance.topLeftCorner<2, 2>() + positionNoise(cluster);
  const Eigen::Matrix<double, 4, 2> gain =
      track->covariance.leftCols<2>() * innovation_covariance.inverse();
  track->state += gain * (cluster.position_in_map - track->state.head<2>());
  track->covariance -= gain * innovation_covariance * gain.transpose();
  track->reported.extent = cluster.extent;
  track->reported.last_stamp = stamp;
  ++track->scans;
}

}  // namespace racecar_mcl
