// Particle sets defined by hand.
#pragma once

#include <cmath>
#include <vector>

#include "racecar_mcl/common/random.h"
#include "racecar_mcl/geometry/particle_set.h"

namespace racecar_mcl {

struct Weighted {
  Pose2 pose;
  double weight;
};

inline ParticleSet setOf(const std::vector<Weighted>& members) {
  ParticleSet particles;
  particles.resize(static_cast<Eigen::Index>(members.size()));
  for (Eigen::Index i = 0; i < particles.size(); ++i) {
    const Weighted& member = members[static_cast<std::size_t>(i)];
    particles.setPose(i, member.pose);
    particles.log_weight[i] = std::log(member.weight);
  }
  return particles;
}

/// `count` equal particles, Gaussian about a pose; their weights sum to `weight`.
inline void scatter(const Pose2& centre, double sigma, int count, double weight, Random& random,
                    std::vector<Weighted>* members) {
  for (int i = 0; i < count; ++i) {
    const double x = centre.x + sigma * random.gaussian();
    const double y = centre.y + sigma * random.gaussian();
    members->push_back({{x, y, wrapAngle(centre.yaw + sigma * random.gaussian())}, weight / count});
  }
}

}  // namespace racecar_mcl
