#include "racecar_mcl/sensor/beam_scores.h"

#include <cmath>

namespace racecar_mcl {
namespace {

constexpr double kGradientStep = 0.025;  // m, of central differences: half a cell of 0.05 m

}  // namespace

Eigen::Matrix4Xd beamScores(const LikelihoodField& field, const Pose2& lidar_in_map,
                            const Scan& beams) {
  const auto at = [&](double dx, double dy) {
    return field.beamLogLikelihoods({lidar_in_map.x + dx, lidar_in_map.y + dy, lidar_in_map.yaw},
                                    beams);
  };
  const Eigen::ArrayXf by_x = at(kGradientStep, 0.0) - at(-kGradientStep, 0.0);
  const Eigen::ArrayXf by_y = at(0.0, kGradientStep) - at(0.0, -kGradientStep);
  Eigen::Matrix4Xd scores = Eigen::Matrix4Xd::Zero(4, beams.size());
  for (Eigen::Index k = 0; k < beams.size(); ++k) {
    if (!std::isfinite(by_x[k]) || !std::isfinite(by_y[k])) continue;
    const double bearing = lidar_in_map.yaw + static_cast<double>(beams.bearings[k]);
    const Eigen::Vector2d along(std::cos(bearing), std::sin(bearing));
    const Eigen::Vector2d gradient =
        Eigen::Vector2d(static_cast<double>(by_x[k]), static_cast<double>(by_y[k])) /
        (2.0 * kGradientStep);
    const double range = static_cast<double>(beams.ranges[k]);
    const double by_yaw = range * (along.x() * gradient.y() - along.y() * gradient.x());
    // A larger bias moves the end point towards the lidar.
    scores.col(k) << gradient.x(), gradient.y(), by_yaw, -along.dot(gradient);
  }
  return scores;
}

}  // namespace racecar_mcl
