// Clusters of a particle set: connected components of occupied histogram bins.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "racecar_mcl/filter/pose_estimate.h"
#include "racecar_mcl/geometry/particle_set.h"
#include "racecar_mcl/geometry/pose_histogram.h"

namespace racecar_mcl {

/// Particles in adjacent bins.
struct Cluster {
  PoseEstimate estimate;
  double weight = 0.0;         ///< fraction of the set's weight, in [0, 1]
  Eigen::Index particles = 0;  ///< number of particles
};

/// Reuses its storage: it allocates only if a set is larger than all earlier ones.
class ClusterFinder {
 public:
  /// The clusters with a weight above zero, heaviest first. Bins are adjacent across faces, edges
  /// and corners, and yaw wraps round. Valid until the next call.
  const std::vector<Cluster>& find(const ParticleSet& particles, const Eigen::ArrayXd& weights,
                                   const PoseBins& bins = {});

 private:
  /// The range of a cluster's particles in the arrays sorted by cluster.
  struct Members {
    std::size_t first = 0;
    std::size_t count = 0;
    double weight = 0.0;
  };

  void reserve(std::size_t particles);
  void joinBins(const PoseBins& bins);
  void sortByCluster(const ParticleSet& particles, const Eigen::ArrayXd& weights);

  std::vector<Cluster> clusters_;
  BinNumbers bins_;
  std::vector<int> bin_of_particle_;
  std::vector<int> cluster_of_bin_;
  std::vector<int> frontier_;                 ///< bins whose neighbours are still to be visited
  std::vector<Members> members_;              ///< of each cluster
  std::vector<double> x_, y_, yaw_, weight_;  ///< of the particles, sorted by cluster
};

/// ClusterFinder::find without reused storage, with the weights of the set.
std::vector<Cluster> findClusters(const ParticleSet& particles, const PoseBins& bins = {});

}  // namespace racecar_mcl
