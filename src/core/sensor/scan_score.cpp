#include "racecar_mcl/sensor/scan_score.h"

#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

constexpr double kGradientStep = 0.025;  // m, of central differences: half a cell of 0.05 m

/// Derivatives of the log-likelihood of each of K beams by the lidar's x and y, 1/m; K x 2.
Eigen::ArrayX2f gradients(const LikelihoodField& field, const Pose2& lidar_in_map,
                          const Scan& beams) {
  const double& x = lidar_in_map.x;
  const double& y = lidar_in_map.y;
  const Eigen::Array4d xs(x + kGradientStep, x - kGradientStep, x, x);
  const Eigen::Array4d ys(y, y, y + kGradientStep, y - kGradientStep);
  const Eigen::Array4d yaws = Eigen::Array4d::Constant(lidar_in_map.yaw);
  Eigen::ArrayXXf values(beams.size(), 4);
  field.beamLogLikelihoods({xs.data(), ys.data(), yaws.data(), 4}, beams, values);
  Eigen::ArrayX2f differences(beams.size(), 2);
  differences << values.col(0) - values.col(1), values.col(2) - values.col(3);
  return differences / static_cast<float>(2.0 * kGradientStep);
}

}  // namespace

ScanScore scanScore(const LikelihoodField& field, const Pose2& lidar_in_map, const Scan& beams) {
  const Eigen::ArrayX2f by_position = gradients(field, lidar_in_map, beams);
  ScanScore sum;
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (!by_position.row(k).isFinite().all()) continue;
    const Eigen::Vector2d gradient = by_position.row(k).cast<double>();
    const double bearing = lidar_in_map.yaw + static_cast<double>(beams.bearings[k]);
    Eigen::Vector2d along;
    sinCos(bearing, &along.y(), &along.x());
    const double range = static_cast<double>(beams.ranges[k]);
    const double by_yaw = range * (along.x() * gradient.y() - along.y() * gradient.x());
    // A larger bias moves the end point towards the lidar.
    const Eigen::Vector4d score(gradient.x(), gradient.y(), by_yaw, -along.dot(gradient));
    sum.score += score;
    sum.information += score * score.transpose();
  }
  const double exponent = field.likelihoodExponent();
  return {exponent * sum.score, exponent * sum.information};
}

}  // namespace racecar_mcl
