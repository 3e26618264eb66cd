// Online calibration of the gyro, and whether it is used.
#pragma once

#include "racecar_mcl/motion/odometry_buffer.h"
#include "racecar_mcl/motion/turn_calibration.h"

namespace racecar_mcl {

enum class GyroUse {
  kNoData,    ///< no samples
  kUnproven,  ///< the car has not turned enough to compare the gyro with the scans
  kUsed,      ///< the turns of the motion are the gyro's
  kWorse,     ///< not used: the odometry's turns agree better with the scans
  kWrong,     ///< not used: the gyro turns another way or another distance than the scans
};

/// Text for logs and diagnostics.
const char* toString(GyroUse use);

/// Compares the gyro with the scans: it is used once it is proven. Drivers that publish degrees per
/// second (the VESC's does) are recognised by the ratio of the turns, if they correlate with the
/// scans'.
class GyroCalibration {
 public:
  /// `distance`: distance constant of the calibration, m; 0 = constant.
  explicit GyroCalibration(double distance);

  /// rad, the motion's turn according to the gyro. Precondition: motion.gyro.
  double turnOf(const Motion& motion) const;

  /// Updates the estimates after one scan. `true_turn`: rad, according to the scans;
  /// `odometry_error`: rad, of the odometry's turns between two scans.
  void learn(const Motion& motion, double true_turn, double odometry_error);

  void restart() { calibration_.restart(); }
  void forgetDelay() { calibration_.forgetDelay(); }

  GyroUse use() const { return use_; }
  bool isUsed() const { return use_ == GyroUse::kUsed; }
  bool isInDegrees() const { return unit_ != 1.0; }
  /// Turn according to the scans per turn of the gyro, as far as observed; 0 before the first turn.
  double ratio() const { return gyro_squared_ > 0.0 ? product_ / gyro_squared_ : 0.0; }
  const TurnCalibration& calibration() const { return calibration_; }

 private:
  void compare(const Motion& motion, double true_turn);
  bool measuresDegrees() const;

  TurnCalibration calibration_;
  GyroUse use_ = GyroUse::kNoData;
  double unit_ = 1.0;       ///< rad per unit of the samples
  double gyro_turn_ = 0.0;  ///< rad, of the comparison that is under way
  double true_turn_ = 0.0;  ///< rad, the same according to the scans
  double seconds_ = 0.0;    ///< s, its duration
  int comparisons_ = 0;
  double turned_ = 0.0;        ///< rad, absolute, compared so far
  double product_ = 0.0;       ///< sum of the products of the scans' turns and the gyro's
  double gyro_squared_ = 0.0;  ///< sum of the squared turns of the gyro
  double true_squared_ = 0.0;  ///< the same of the scans' turns
};

}  // namespace racecar_mcl
