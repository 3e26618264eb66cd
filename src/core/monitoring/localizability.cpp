#include "racecar_mcl/monitoring/localizability.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace racecar_mcl {
namespace {

// Standard deviation of the pose without any scan, so that the inverse exists.
constexpr double kMaxSigma = 10.0;  // m, rad
// The field's scale stands for lidar noise and map errors together; the likelihood of a beam that
// ends at half of it has nearly its steepest slope.
constexpr double kDisplacementPerScale = 0.5;

}  // namespace

Eigen::Matrix3d expectedInformation(const MapView& map, const LikelihoodField& field,
                                    const Pose2& lidar_in_map, const Eigen::ArrayXf& bearings) {
  Eigen::ArrayXXf ranges(bearings.size(), 1);
  map.caster.cast(batchOf(lidar_in_map), bearings, ranges);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const double sign : {-1.0, 1.0}) {
    Scan beams;
    beams.bearings = bearings;
    beams.ranges = ranges.col(0) + static_cast<float>(sign * kDisplacementPerScale * field.scale());
    // Nothing returns from beyond the map's surfaces.
    beams.ranges = (ranges.col(0) < static_cast<float>(map.caster.maxRange()))
                       .select(beams.ranges, std::numeric_limits<float>::infinity());
    beams.seconds_after_stamp = Eigen::ArrayXf::Zero(bearings.size());
    information += 0.5 * poseInformation(scanScore(field, lidar_in_map, beams));
  }
  return information;
}

Eigen::Matrix3d covarianceOf(const Eigen::Matrix3d& information) {
  Eigen::Matrix3d total = information;
  total.diagonal().array() += 1.0 / (kMaxSigma * kMaxSigma);
  return total.ldlt().solve(Eigen::Matrix3d::Identity());
}

Localizability localizabilityOf(const Eigen::Matrix3d& information, double yaw) {
  const Eigen::Matrix3d covariance = covarianceOf(information);
  const Eigen::Vector2d along(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Matrix2d position = covariance.topLeftCorner<2, 2>();
  const auto sigma = [](double variance) { return std::sqrt(std::max(0.0, variance)); };
  return {sigma(along.dot(position * along)), sigma(across.dot(position * across)),
          sigma(covariance(2, 2))};
}

}  // namespace racecar_mcl
