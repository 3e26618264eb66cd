#include "racecar_mcl/range_bias.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

constexpr double kMaxBias = 0.1;         // m
constexpr double kPriorSigma = 0.02;     // m, of the bias at the start
constexpr double kDecorrelation = 2.0;   // m driven between independent scans
constexpr float kMinRange = 0.01f;       // m, that a correction leaves
constexpr double kGradientStep = 0.025;  // m, of the central differences on the field
// What is known of the pose but for this scan: keeps the marginalisation regular where the scan
// does not observe a direction, as along a corridor. m, m, rad.
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

void RangeBias::reset() {
  bias_ = parameters_.range_bias;
  information_ = 1.0 / (kPriorSigma * kPriorSigma);
}

void RangeBias::correct(Scan* scan) const {
  if (bias_ == 0.0) return;
  scan->ranges = (scan->ranges - static_cast<float>(bias_)).max(kMinRange);
}

void RangeBias::learn(const LikelihoodField& field, const Pose2& base_in_map, const Scan& beams,
                      double travelled) {
  if (parameters_.range_bias_distance <= 0.0) return;
  const Pose2 lidar = compose(base_in_map, beams.laser_in_base);
  const auto at = [&](double dx, double dy) {
    return field.beamLogLikelihoods({lidar.x + dx, lidar.y + dy, lidar.yaw}, beams);
  };
  const Eigen::ArrayXf by_x = at(kGradientStep, 0.0) - at(-kGradientStep, 0.0);
  const Eigen::ArrayXf by_y = at(0.0, kGradientStep) - at(0.0, -kGradientStep);

  // Of each beam the score by (x, y, yaw, bias); a larger bias moves the end towards the lidar.
  Eigen::Vector4d score = Eigen::Vector4d::Zero();
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (!std::isfinite(by_x[k]) || !std::isfinite(by_y[k])) continue;
    const double bearing = lidar.yaw + static_cast<double>(beams.bearings[k]);
    const Eigen::Vector2d along(std::cos(bearing), std::sin(bearing));
    const Eigen::Vector2d gradient =
        Eigen::Vector2d(static_cast<double>(by_x[k]), static_cast<double>(by_y[k])) /
        (2.0 * kGradientStep);
    const double range = static_cast<double>(beams.ranges[k]);
    const double by_yaw = range * (along.x() * gradient.y() - along.y() * gradient.x());
    const Eigen::Vector4d by(gradient.x(), gradient.y(), by_yaw, -along.dot(gradient));
    score += by;
    information += by * by.transpose();
  }
  const double share = 1.0 / field.squash();
  score *= share;
  information *= share;

  Eigen::Matrix3d of_pose = information.topLeftCorner<3, 3>();
  of_pose.diagonal() += kPosePriorSigma.cwiseAbs2().cwiseInverse();
  const Eigen::Vector3d shared = of_pose.ldlt().solve(information.topRightCorner<3, 1>());
  // Scans taken close together see the same surfaces.
  const double news = std::min(1.0, travelled / kDecorrelation);
  const double of_bias =
      news * (information(3, 3) - shared.dot(information.topRightCorner<3, 1>()));
  const double score_of_bias = news * (score[3] - shared.dot(score.head<3>()));

  const double keep = std::exp(-travelled / parameters_.range_bias_distance);
  const double prior = 1.0 / (kPriorSigma * kPriorSigma);
  information_ = prior + keep * (information_ - prior) + std::max(0.0, of_bias);
  bias_ = std::clamp(bias_ + score_of_bias / information_, -kMaxBias, kMaxBias);
}

}  // namespace racecar_mcl
