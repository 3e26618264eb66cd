// Odometry and gyro with their calibration: the car's corrected motion between any two times.
#pragma once

#include <optional>

#include "racecar_mcl/motion/gyro_buffer.h"
#include "racecar_mcl/motion/odometry_buffer.h"
#include "racecar_mcl/motion/odometry_calibration.h"

namespace racecar_mcl {

/// The state of the odometry at a time; motions are measured from it.
struct MotionOrigin {
  double stamp = 0.0;
  OdometryState odometry;
};

/// A copyable value: a copy is a snapshot for the processing of one scan.
class CalibratedOdometry {
 public:
  /// Throws as the parameters' validate function does.
  explicit CalibratedOdometry(const OdometryParameters& parameters = {});

  /// For the messages from now on; clock_jump is not changed. Throws as the
  /// constructor, and then changes nothing.
  void setParameters(const OdometryParameters& parameters) { odometry_.setParameters(parameters); }

  OdometryOutcome add(const OdometrySample& sample) { return odometry_.add(sample); }
  /// The gyro's bias is measured while the odometry says that the car is at rest.
  GyroOutcome add(const GyroSample& sample) {
    return gyro_.add(sample, odometry_.isAtRest(sample.stamp));
  }
  /// Removes odometry and gyro samples, for a restart of the clock.
  void reset();

  const OdometryBuffer& odometry() const { return odometry_; }
  const OdometryCalibration& calibration() const { return calibration_; }
  void setCalibration(const OdometryCalibration& calibration) { calibration_ = calibration; }

  /// Motions have this constant twist instead of the odometry's, if given.
  void replaceTwist(const std::optional<Twist2>& twist) { twist_ = twist; }

  /// The state at a time, corrected for the delays.
  MotionOrigin at(double stamp) const;
  /// The corrected motion from an origin to a time; the origin may be the later one.
  Motion motion(const MotionOrigin& from, double stamp) const;

  /// A copy without the messages that motions after this time do not need.
  CalibratedOdometry since(double stamp) const;

 private:
  OdometryBuffer odometry_;
  GyroBuffer gyro_;
  OdometryCalibration calibration_;
  std::optional<Twist2> twist_;
};

}  // namespace racecar_mcl
