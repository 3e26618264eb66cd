// A histogram over (x, y, yaw) that stores only the bins that hold particles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "racecar_mcl/particles.h"
#include "racecar_mcl/resampling.h"

namespace racecar_mcl {

/// The bin of a pose. Yaw bins wrap round: there are yawBinCount of them.
struct PoseBin {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t yaw = 0;

  bool operator==(const PoseBin& other) const {
    return x == other.x && y == other.y && yaw == other.yaw;
  }
};

struct PoseBinHash {
  std::size_t operator()(const PoseBin& bin) const {
    std::uint64_t hash = static_cast<std::uint32_t>(bin.x) * 0x9e3779b97f4a7c15ULL;
    hash = (hash ^ (hash >> 29)) + static_cast<std::uint32_t>(bin.y) * 0xbf58476d1ce4e5b9ULL;
    hash = (hash ^ (hash >> 31)) + static_cast<std::uint32_t>(bin.yaw) * 0x94d049bb133111ebULL;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

inline std::int32_t yawBinCount(const PoseBins& bins) {
  return std::max(1, static_cast<std::int32_t>(std::lround(2.0 * kPi / bins.yaw)));
}

inline PoseBin binOf(const Pose2& pose, const PoseBins& bins) {
  const std::int32_t yaw_bins = yawBinCount(bins);
  const double turn = (wrapAngle(pose.yaw) + kPi) / (2.0 * kPi);
  // Far bins are merged before they overflow an index.
  const auto index = [&](double position) {
    return static_cast<std::int32_t>(
        std::floor(std::min(std::max(-1e9, position / bins.position), 1e9)));
  };
  return {index(pose.x), index(pose.y),
          std::min(static_cast<std::int32_t>(turn * yaw_bins), yaw_bins - 1)};
}

using BinnedParticles = std::unordered_map<PoseBin, std::vector<Eigen::Index>, PoseBinHash>;

inline BinnedParticles groupByBin(const ParticleSet& particles, const PoseBins& bins) {
  BinnedParticles groups;
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    groups[binOf(particles.pose(i), bins)].push_back(i);
  }
  return groups;
}

/// Whether all particles lie in bins that touch, across edges and corners. Allocates nothing.
/// False, too, for sets wider than some 60 bins, and bins of more than 32 yaws.
bool lieInOnePlace(const ParticleSet& particles, const PoseBins& bins);

}  // namespace racecar_mcl
