#include "racecar_mcl/filter/clustering.h"

#include <algorithm>
#include <tuple>

#include "filter/single_cluster_check.h"
#include "racecar_mcl/filter/resampling.h"

namespace racecar_mcl {
namespace {

/// Visits the bins within one step in x, y and yaw, the bin itself included.
template <typename Visit>
void forEachNeighbour(const PoseBin& bin, std::int32_t yaw_bins, Visit&& visit) {
  for (std::int32_t dx = -1; dx <= 1; ++dx) {
    for (std::int32_t dy = -1; dy <= 1; ++dy) {
      for (std::int32_t dyaw = -1; dyaw <= 1; ++dyaw) {
        visit(PoseBin{bin.x + dx, bin.y + dy, (bin.yaw + dyaw + yaw_bins) % yaw_bins});
      }
    }
  }
}

}  // namespace

const std::vector<Cluster>& ClusterFinder::find(const ParticleSet& particles,
                                                const Eigen::ArrayXd& weights,
                                                const PoseBins& bins) {
  reserve(static_cast<std::size_t>(particles.size()));
  clusters_.clear();
  if (particles.size() > 0 && formSingleCluster(particles, bins)) {
    clusters_.push_back({weightedMean(particles, weights), 1.0, particles.size()});
    return clusters_;
  }
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    bin_of_particle_[static_cast<std::size_t>(i)] = bins_.add(binOf(particles.pose(i), bins));
  }
  joinBins(bins);
  sortByCluster(particles, weights);

  double total = 0.0;
  for (const Members& members : members_) total += members.weight;
  members_.erase(std::remove_if(members_.begin(), members_.end(),
                                [](const Members& members) { return !(members.weight > 0.0); }),
                 members_.end());
  // Ties are broken by the order of the particles.
  std::sort(members_.begin(), members_.end(), [](const Members& a, const Members& b) {
    return std::tie(b.weight, a.first) < std::tie(a.weight, b.first);
  });
  for (const Members& members : members_) {
    const auto count = static_cast<Eigen::Index>(members.count);
    const PoseBatch poses{&x_[members.first], &y_[members.first], &yaw_[members.first], count};
    clusters_.push_back(
        {weightedMean(poses, &weight_[members.first]), members.weight / total, count});
  }
  return clusters_;
}

/// For the worst case: one cluster per particle.
void ClusterFinder::reserve(std::size_t particles) {
  clusters_.reserve(particles);
  bins_.reset(particles);
  bin_of_particle_.resize(particles);
  cluster_of_bin_.reserve(particles);
  frontier_.reserve(particles);
  members_.reserve(particles);
  for (std::vector<double>* values : {&x_, &y_, &yaw_, &weight_}) values->resize(particles);
}

void ClusterFinder::joinBins(const PoseBins& bins) {
  const std::int32_t yaw_bins = yawBinCount(bins);
  cluster_of_bin_.assign(static_cast<std::size_t>(bins_.size()), -1);
  members_.clear();
  // Bins are numbered in the order of the particles, so that the result does not depend on hashes.
  for (int seed = 0; seed < bins_.size(); ++seed) {
    const auto join = [&](int bin) {
      int& cluster = cluster_of_bin_[static_cast<std::size_t>(bin)];
      if (cluster >= 0) return;
      cluster = static_cast<int>(members_.size());
      frontier_.push_back(bin);
    };
    join(seed);
    if (frontier_.empty()) continue;
    while (!frontier_.empty()) {
      const PoseBin bin = bins_[frontier_.back()];
      frontier_.pop_back();
      forEachNeighbour(bin, yaw_bins, [&](const PoseBin& next) {
        const int number = bins_.find(next);
        if (number >= 0) join(number);
      });
    }
    members_.emplace_back();
  }
}

void ClusterFinder::sortByCluster(const ParticleSet& particles, const Eigen::ArrayXd& weights) {
  const auto membersWith = [&](std::size_t i) -> Members& {
    const int cluster = cluster_of_bin_[static_cast<std::size_t>(bin_of_particle_[i])];
    return members_[static_cast<std::size_t>(cluster)];
  };
  const std::size_t size = bin_of_particle_.size();
  for (std::size_t i = 0; i < size; ++i) ++membersWith(i).count;
  std::size_t first = 0;
  for (Members& members : members_) {
    members.first = first;
    first += members.count;
    members.count = 0;
  }
  for (std::size_t i = 0; i < size; ++i) {
    Members& members = membersWith(i);
    const std::size_t at = members.first + members.count++;
    const auto particle = static_cast<Eigen::Index>(i);
    x_[at] = particles.x[particle];
    y_[at] = particles.y[particle];
    yaw_[at] = particles.yaw[particle];
    weight_[at] = weights[particle];
    members.weight += weight_[at];
  }
}

std::vector<Cluster> findClusters(const ParticleSet& particles, const PoseBins& bins) {
  return ClusterFinder().find(particles, weightsOf(particles), bins);
}

}  // namespace racecar_mcl
