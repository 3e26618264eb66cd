// How well a scan determines the pose.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/scan/scan.h"
#include "racecar_mcl/sensor/map_view.h"
#include "racecar_mcl/sensor/scan_score.h"

namespace racecar_mcl {

/// Standard deviations of a pose that is determined by one scan alone (Cramer-Rao bound), at most
/// 10 m and 10 rad. Along and across a corridor they differ by orders of magnitude.
struct Localizability {
  double along = 10.0;    ///< m, in the car's direction
  double across = 10.0;   ///< m
  double heading = 10.0;  ///< rad
};

/// Fisher information of a scan about the lidar's (x, y, yaw) in the map.
inline Eigen::Matrix3d poseInformation(const ScanScore& scan) {
  return scan.information.topLeftCorner<3, 3>();
}

/// The information that a scan with these bearings (rad) can be expected to have: the beams end at
/// the map's surfaces, displaced by their noise (half of field_scale).
Eigen::Matrix3d expectedInformation(const MapView& map, const LikelihoodField& field,
                                    const Pose2& lidar_in_map, const Eigen::ArrayXf& bearings);

/// The covariance (m, m, rad) of the pose: the inverse, limited as above.
Eigen::Matrix3d covarianceOf(const Eigen::Matrix3d& information);

/// `yaw`: rad, the car's heading in the map.
Localizability localizabilityOf(const Eigen::Matrix3d& information, double yaw);

}  // namespace racecar_mcl
