#include "racecar_mcl/odometry_doubt.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

constexpr double kMemory = 0.25;  // s
// A sum of corrections is a surprise from so many squared sigmas on: chance, with its three degrees
// of freedom, gets there once in five thousand times. Then the noise grows until it is this many.
constexpr double kSurprise = 20.0;
constexpr double kUnsurprising = 5.0;
constexpr double kMostFactor = 8.0;
// Corrections below this say nothing, however sure the motion model is: m, m, rad.
const Eigen::Vector3d kFloor(1e-3, 1e-3, 1e-3);

}  // namespace

void OdometryDoubt::learn(const Pose2& correction, const Eigen::Matrix3d& noise, double seconds) {
  const double keep = std::exp(-std::max(0.0, seconds) / kMemory);
  correction_ = keep * correction_ + Eigen::Vector3d(correction.x, correction.y, correction.yaw);
  noise_ = keep * keep * noise_ + noise;
}

double OdometryDoubt::noiseFactor() const {
  Eigen::Matrix3d noise = noise_;
  noise.diagonal() += kFloor.cwiseAbs2();
  const double surprise = correction_.dot(noise.ldlt().solve(correction_));
  return surprise < kSurprise ? 1.0 : std::min(std::sqrt(surprise / kUnsurprising), kMostFactor);
}

}  // namespace racecar_mcl
