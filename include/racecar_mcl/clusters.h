// The places where the particles of a set are.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/particles.h"
#include "racecar_mcl/pose_bins.h"
#include "racecar_mcl/pose_estimate.h"

namespace racecar_mcl {

/// Particles that lie in touching bins.
struct Cluster {
  PoseEstimate estimate;
  double weight = 0.0;         ///< share of the whole set, in [0, 1]
  Eigen::Index particles = 0;  ///< how many
};

/// Keeps its storage from set to set: it allocates only where a set is larger than all before it.
class ClusterFinder {
 public:
  /// The clusters of the set that weigh anything, heaviest first; bins touch across edges and
  /// corners, and yaw wraps round. Valid until the next call.
  const std::vector<Cluster>& find(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                                   const PoseBins& bins = {});

 private:
  /// A cluster's particles among those sorted by cluster.
  struct Members {
    std::size_t first = 0;
    std::size_t count = 0;
    double weight = 0.0;
  };

  void makeRoom(std::size_t particles);
  void joinBins(const PoseBins& bins);
  void sortByCluster(const ParticleSet& particles, const Eigen::ArrayXd& weights);

  std::vector<Cluster> clusters_;
  BinNumbers bins_;
  std::vector<int> bin_of_particle_;
  std::vector<int> cluster_of_bin_;
  std::vector<int> frontier_;                 ///< bins whose neighbours have not been looked at
  std::vector<Members> members_;              ///< of each cluster
  std::vector<double> x_, y_, yaw_, weight_;  ///< of the particles, sorted by cluster
};

/// The same, once.
std::vector<Cluster> findClusters(const ParticleSet& particles, const PoseBins& bins = {});

}  // namespace racecar_mcl
