// What a scan says of every particle, by the map's sensor model, on one thread or several.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/particles.h"
#include "racecar_mcl/scan.h"

namespace racecar_mcl {

class LikelihoodField;
struct MapModel;

/// Keeps its arrays from scan to scan: it allocates only where a scan has more beams or particles
/// than the one before.
class ScanWeigher {
 public:
  /// `threads`: 0 = one per core. The result is the same to the bit.
  explicit ScanWeigher(int threads) : threads_(threads) {}

  /// The squashed log-likelihood of the scan for each particle, by the map's likelihood field where
  /// there is one, else by casting rays. Valid until the next call.
  Eigen::ArrayXd& weigh(MapModel* map, const ParticleSet& particles, const Scan& beams);

  /// The same by a field of its own.
  Eigen::ArrayXd& weigh(const LikelihoodField& field, const ParticleSet& particles,
                        const Scan& beams);

 private:
  PoseBatch lidars() const {
    return {lidar_x_.data(), lidar_y_.data(), lidar_yaw_.data(), lidar_x_.size()};
  }
  void place(const ParticleSet& particles, const Pose2& laser_in_base);

  int threads_;
  Eigen::ArrayXd lidar_x_, lidar_y_, lidar_yaw_;
  Eigen::ArrayXXf ranges_;  ///< of a few particles per thread, one column each
  Eigen::ArrayXd log_likelihoods_;
};

}  // namespace racecar_mcl
