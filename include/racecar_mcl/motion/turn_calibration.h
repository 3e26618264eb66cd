// Online calibration of a sensor of the car's turns: the odometry's turn rate or a gyro.
#pragma once

#include <Eigen/Core>

namespace racecar_mcl {

/// A turn as a sensor measured it between two scans.
struct MeasuredTurn {
  double turn = 0.0;  ///< rad
  /// What the offset is multiplied by: m driven for odometry, s for a gyro.
  double exposure = 0.0;
  double rate_change = 0.0;  ///< rad/s, turn rate at the end minus that at the beginning
};

/// Standard deviations of the prior, and limits, of a sensor's systematic errors.
struct TurnErrors {
  double scale_sigma = 0.0;      ///< rad per rad
  double offset_sigma = 0.0;     ///< rad per m or rad per s
  double max_scale_error = 0.0;  ///< rad per rad, of the sensor: it measures (1 +- this) turns
  double max_offset = 0.0;       ///< rad per m or rad per s
  double max_delay = 0.0;        ///< s
};

/// The systematic errors of a sensor of turns, as estimated.
struct TurnConstants {
  double scale = 1.0;   ///< true radians per measured radian
  double offset = 0.0;  ///< rad per m or s, not measured by the sensor
  double delay = 0.0;   ///< s by which the sensor lags the car's motion
};

/// Scale and offset by recursive least squares with a forgetting factor over blocks of 1 m, so that
/// the noise of the measured turns does not reduce the scale; the delay by least squares on what is
/// left of the errors when the turn rate changes (docs/maths.md).
class TurnCalibration {
 public:
  /// `distance`: distance constant of the forgetting, m; 0 = constant.
  TurnCalibration(const TurnErrors& errors, double distance);

  /// rad, with the systematic errors removed; the delay is applied by the caller.
  double correct(double turn, double exposure) const {
    return estimates_.scale * turn + estimates_.offset * exposure;
  }

  /// Updates the estimates after one scan. `true_turn`: rad, according to the scans; `travelled`:
  /// m.
  void learn(const MeasuredTurn& measured, double true_turn, double travelled);

  /// Continues from the estimates of an earlier run, within the limits.
  void resume(const TurnConstants& constants);

  /// The pose was set anew: its corrections over the next 1 m are not errors of the sensor.
  void restart();

  /// Resets the delay, if the times of beams were wrong.
  void forgetDelay() { estimates_.delay = delay_information_ = 0.0; }

  const TurnConstants& estimates() const { return estimates_; }
  double scale() const { return estimates_.scale; }
  double offset() const { return estimates_.offset; }
  double delay() const { return estimates_.delay; }
  /// rad, root mean square error of the corrected turns between two scans; fades over 30 scans.
  double error() const;

 private:
  /// The sum since the last update of scale and offset.
  struct Block {
    double turn = 0.0;  ///< rad, measured
    double exposure = 0.0;
    double true_turn = 0.0;  ///< rad
    double travelled = 0.0;  ///< m
  };

  void learnBlock();
  double boundedScale(double scale) const;
  void learnDelay(double rate_change, double error, double memory);

  TurnErrors errors_;
  double distance_;
  TurnConstants estimates_;
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Zero();  ///< of the scans, without the prior
  double delay_information_ = 0.0;  ///< (rad/s)^2, fading sum of squared changes of the turn rate
  Block block_;
  bool block_is_first_ = true;  ///< since a restart
  double squared_error_ = 0.0;  ///< rad^2, fading mean
  double scans_ = 0.0;          ///< number of scans in squared_error_, fading
};

}  // namespace racecar_mcl
