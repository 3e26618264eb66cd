// Where the lidar is for each particle.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/particles.h"
#include "racecar_mcl/pose.h"

namespace racecar_mcl {

struct LidarPoses {
  Eigen::ArrayXd x, y, yaw;
  PoseBatch batch() const { return {x.data(), y.data(), yaw.data(), x.size()}; }
};

inline LidarPoses lidarPoses(const ParticleSet& particles, const Pose2& laser_in_base) {
  const Eigen::ArrayXd c = particles.yaw.cos();
  const Eigen::ArrayXd s = particles.yaw.sin();
  return {particles.x + c * laser_in_base.x - s * laser_in_base.y,
          particles.y + s * laser_in_base.x + c * laser_in_base.y,
          particles.yaw + laser_in_base.yaw};
}

}  // namespace racecar_mcl
