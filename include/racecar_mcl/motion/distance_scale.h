// Online estimation of the distance scale of the odometry.
#pragma once

#include <Eigen/Core>

#include "racecar_mcl/motion/odometry_buffer.h"

namespace racecar_mcl {

/// The correction of a predicted pose by a scan, in the frame of the predicted pose.
struct PoseCorrection {
  Pose2 pose;  ///< the estimate
  /// Covariance of the position before and after the correction, m^2.
  Eigen::Matrix2d before = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d after = Eigen::Matrix2d::Zero();
};

/// Whether the map shows nearly all that the lidar sees.
struct MapFit {
  bool map_is_complete = false;    ///< on average
  bool scan_is_explained = false;  ///< and in this scan
};

/// True metres per metre of odometry. In the first metres on a complete map a Kalman filter of
/// scale and position estimates it, and the motion noise includes its uncertainty; then it is the
/// mean of the corrections by scans (docs/maths.md).
class DistanceScale {
 public:
  /// `adaptation_distance`: m driven, distance constant of the mean; 0 = constant scale.
  explicit DistanceScale(double adaptation_distance);

  /// The variance (m^2) that the scale adds along a corrected motion of this length (m).
  double varianceAlong(double length) const;

  /// `motion`: corrected motion since the last scan.
  void learn(const Motion& motion, const PoseCorrection& correction, const MapFit& fit);

  /// The pose was set anew: its error is independent of the scale.
  void restart() { covariance_.setZero(); }

  /// Continues from an earlier run, within the limits.
  void resume(double scale, double distance);

  double scale() const { return scale_; }
  double distance() const { return distance_; }  ///< m driven on a complete map

 private:
  void filter(const Motion& motion, const PoseCorrection& correction);
  void average(const Motion& motion, double along, double distance);
  void change(double difference);

  double adaptation_distance_;
  double scale_ = 1.0;
  double distance_ = 0.0;
  bool filters_ = false;
  double variance_;  ///< of the scale
  /// Of position (m, in the frame of the car) and scale.
  Eigen::Vector2d covariance_ = Eigen::Vector2d::Zero();
};

}  // namespace racecar_mcl
