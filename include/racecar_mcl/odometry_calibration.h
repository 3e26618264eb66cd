// Learns while driving by which factors the odometry is off, from how scans correct it.
#pragma once

#include "racecar_mcl/odometry.h"

namespace racecar_mcl {

struct OdometryCalibrationParameters {
  double calibration_distance = 100.0;  ///< m driven, or rad turned, over which an error that stays
                                        ///< is learned to all but a third; 0 = never
};

/// Throws ParameterError on a distance that is neither 0 nor in [1, 1e6].
void validate(const OdometryCalibrationParameters& parameters);

/// Four errors that stay: of the wheel's size, of the turn, of the steering's middle, and of the
/// time that odometry is late by. While they are not known every scan corrects them anew and none
/// quite enough, so that the pose runs ahead of the car or behind it; what the scans correct on
/// average is the error itself.
class OdometryCalibration {
 public:
  /// Throws as `validate` does.
  explicit OdometryCalibration(const OdometryCalibrationParameters& parameters = {});

  /// The motion as it would have been with odometry that is not off.
  Motion correct(const Motion& motion) const;

  /// Learns from one scan: `motion` is the corrected motion since the scan before, `correction` the
  /// pose that the scan led to, seen from the pose before it was weighed.
  void learn(const Motion& motion, const Pose2& correction);

  /// Scans were found to have been taken at other times than was thought.
  void forgetDelay() { delay_ = delay_information_ = 0.0; }

  double distanceScale() const { return distance_scale_; }  ///< true metres per metre of odometry
  double turnScale() const { return turn_scale_; }          ///< true radians per radian of odometry
  double curvature() const { return curvature_; }           ///< rad/m that odometry does not see
  /// s by which odometry tells late how the car moved; negative where it tells early, as twists do
  /// that hold for the time before them.
  double delay() const { return delay_; }

 private:
  void learnDelay(const Motion& motion, const Pose2& correction);

  OdometryCalibrationParameters parameters_;
  double distance_scale_ = 1.0;
  double turn_scale_ = 1.0;
  double curvature_ = 0.0;
  double delay_ = 0.0;
  double delay_information_ = 0.0;  ///< (m/s)^2, what changes of speed have told of the delay
};

}  // namespace racecar_mcl
