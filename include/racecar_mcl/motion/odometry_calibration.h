// Online calibration of systematic odometry errors from the corrections by scans.
#pragma once

#include "racecar_mcl/motion/distance_scale.h"
#include "racecar_mcl/motion/gyro_calibration.h"
#include "racecar_mcl/motion/odometry_buffer.h"
#include "racecar_mcl/motion/turn_calibration.h"

namespace racecar_mcl {

struct OdometryCalibrationParameters {
  /// Distance constant of the adaptation, m driven or rad turned; 0 = off. On a complete map the
  /// distance scale adapts faster at first.
  double calibration_distance = 100.0;
};

/// Throws ParameterError on a distance that is neither 0 nor in [1, 1e6].
void validate(const OdometryCalibrationParameters& parameters);

/// The systematic errors of the odometry, as estimated.
struct OdometryErrors {
  double distance_scale = 1.0;  ///< true metres per metre of odometry
  double delay = 0.0;           ///< s by which the speed lags the car's motion
  TurnConstants turn;           ///< the offset per m
  double scale_distance = 0.0;  ///< m driven on a complete map, which determined distance_scale
};

/// Systematic errors: distance scale and time delay of the speed, and those of the turns, which the
/// gyro measures if there is one and it is proven, else the odometry. They bias the pose, since
/// each scan corrects only a part of them. The mean correction by scans is an estimate of the error
/// (docs/maths.md).
class OdometryCalibration {
 public:
  /// Throws as `validate` does.
  explicit OdometryCalibration(const OdometryCalibrationParameters& parameters = {});

  /// The estimates are kept unless a parameter changes. Throws as the constructor, and then changes
  /// nothing.
  void setParameters(const OdometryCalibrationParameters& parameters) {
    const bool changes = parameters.calibration_distance != parameters_.calibration_distance;
    if (changes) *this = OdometryCalibration(parameters);
  }

  /// The motion with the estimated errors removed; the delays are applied by the caller.
  Motion correct(const Motion& motion) const;

  /// Updates the estimates after one scan. `motion`: corrected motion since the last scan.
  void learn(const Motion& motion, const PoseCorrection& correction, const MapFit& fit);

  /// Continues from the estimates of an earlier run, within the limits. A gyro proves itself anew.
  void resume(const OdometryErrors& errors);

  /// The pose was set anew: its corrections over the next 1 m are not errors of the turns.
  void restart();

  /// Resets the delays, if the times of beams were wrong.
  void forgetDelay();

  double distanceScale() const { return distance_.scale(); }  ///< true metres per metre of odometry
  /// s by which the odometry's speed lags the car's motion. Negative if it leads, as twists that
  /// are valid for the time before their stamps.
  double delay() const { return delay_; }
  OdometryErrors errors() const {
    return {distance_.scale(), delay_, odometry_turn_.estimates(), distance_.distance()};
  }
  const TurnCalibration& odometryTurn() const { return odometry_turn_; }
  const GyroCalibration& gyro() const { return gyro_; }

 private:
  void updateDelay(const Motion& motion, const Pose2& correction);

  OdometryCalibrationParameters parameters_;
  DistanceScale distance_;
  double delay_ = 0.0;
  double delay_information_ = 0.0;  ///< (m/s)^2, fading sum of squared changes of speed
  TurnCalibration odometry_turn_;
  GyroCalibration gyro_;
};

}  // namespace racecar_mcl
