#include "racecar_mcl/sensor/range_bias.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

constexpr double kMaxBias = 0.1;                // m (docs/maths.md)
constexpr double kPriorSigma = 0.02;            // m, of the initial bias (docs/maths.md)
constexpr double kDecorrelationDistance = 2.0;  // m driven between independent scans
// Prior of the pose: regularizes the marginalisation if the scan does not observe a direction, as
// along a corridor. m, m, rad.
const Eigen::Vector3d kPosePriorSigma(0.1, 0.1, 0.05);

}  // namespace

void validate(const RangeBiasParameters& p) {
  requireWithin("range_bias", p.range_bias, -kMaxBias, kMaxBias, "m");
  requireWithin("range_bias_distance", p.range_bias_distance, 0.0, 1e6, "m");
}

RangeBias::RangeBias(const RangeBiasParameters& parameters)
    : parameters_((validate(parameters), parameters)) {
  reset();
}

void RangeBias::setParameters(const RangeBiasParameters& parameters) {
  validate(parameters);
  const bool restarts = parameters.range_bias != parameters_.range_bias;
  parameters_ = parameters;
  if (restarts) reset();
}

void RangeBias::reset() {
  bias_ = parameters_.range_bias;
  information_ = 1.0 / (kPriorSigma * kPriorSigma);
}

void RangeBias::resume(double bias) {
  if (parameters_.range_bias_distance > 0.0) bias_ = std::clamp(bias, -kMaxBias, kMaxBias);
}

void RangeBias::learn(const ScanScore& scan, double travelled) {
  if (parameters_.range_bias_distance <= 0.0) return;
  const Eigen::Matrix4d& information = scan.information;
  Eigen::Matrix3d pose_information = information.topLeftCorner<3, 3>();
  pose_information.diagonal() += kPosePriorSigma.cwiseAbs2().cwiseInverse();
  // Schur complement: marginalises the pose.
  const Eigen::Vector3d coupling =
      pose_information.ldlt().solve(information.topRightCorner<3, 1>());
  // Scans taken close together see the same surfaces.
  const double decorrelation = std::min(1.0, travelled / kDecorrelationDistance);
  const double bias_information =
      decorrelation * (information(3, 3) - coupling.dot(information.topRightCorner<3, 1>()));
  const double bias_score = decorrelation * (scan.score[3] - coupling.dot(scan.score.head<3>()));

  const double keep = std::exp(-travelled / parameters_.range_bias_distance);
  const double prior = 1.0 / (kPriorSigma * kPriorSigma);
  information_ = prior + keep * (information_ - prior) + std::max(0.0, bias_information);
  bias_ = std::clamp(bias_ + bias_score / information_, -kMaxBias, kMaxBias);
}

}  // namespace racecar_mcl
