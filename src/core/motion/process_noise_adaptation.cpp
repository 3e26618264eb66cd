#include "racecar_mcl/motion/process_noise_adaptation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace racecar_mcl {
namespace {

constexpr double kTimeConstant = 0.25;  // s, of the fading sum (docs/maths.md)
// NIS above which the noise is scaled: a chi-squared variable with three degrees of freedom exceeds
// it about once in five thousand times. The scale brings the NIS down to the target.
constexpr double kNisThreshold = 20.0;
constexpr double kNisTarget = 5.0;
constexpr double kMaxNoiseScale = 8.0;
// Minimum standard deviation of a correction: m, m, rad.
const Eigen::Vector3d kMinSigma(1e-3, 1e-3, 1e-3);

}  // namespace

void ProcessNoiseAdaptation::learn(const Pose2& correction, const Eigen::Matrix3d& noise,
                                   double seconds) {
  const double keep = std::exp(-std::max(0.0, seconds) / kTimeConstant);
  correction_ = keep * correction_ + Eigen::Vector3d(correction.x, correction.y, correction.yaw);
  noise_ = keep * keep * noise_ + noise;
}

double ProcessNoiseAdaptation::noiseScale() const {
  Eigen::Matrix3d noise = noise_;
  noise.diagonal() += kMinSigma.cwiseAbs2();
  const double nis = correction_.dot(noise.ldlt().solve(correction_));
  return nis < kNisThreshold ? 1.0 : std::min(std::sqrt(nis / kNisTarget), kMaxNoiseScale);
}

}  // namespace racecar_mcl
