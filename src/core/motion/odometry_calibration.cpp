#include "racecar_mcl/motion/odometry_calibration.h"

#include <algorithm>
#include <cmath>

#include "motion/scalars.h"
#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

// Limits of the estimates (docs/decisions.md): larger errors are faults rather than miscalibration.
constexpr double kMaxDelay = 0.1;  // s
// Odometry of cars integrates the commanded steering angle: a published lap of a 1/10 car has a
// heading error of 60 %. The steering lags its command by up to 0.2 s.
const TurnErrors kOdometryTurnErrors{0.3, 0.02, 0.65, 0.1, 0.2};

// Prior information of a delay of zero (docs/maths.md), so that no single scan determines the
// delay.
constexpr double kDistanceDelayPrior = 0.125;  // (m/s)^2

}  // namespace

void validate(const OdometryCalibrationParameters& p) {
  require(p.calibration_distance == 0.0 ||
              (p.calibration_distance >= 1.0 && p.calibration_distance <= 1e6),
          "calibration_distance", p.calibration_distance, "0 (off) or between 1 and 1000000", "m");
}

OdometryCalibration::OdometryCalibration(const OdometryCalibrationParameters& parameters)
    : parameters_((validate(parameters), parameters)),
      distance_(parameters.calibration_distance),
      odometry_turn_(kOdometryTurnErrors, parameters.calibration_distance),
      gyro_(parameters.calibration_distance) {}

Motion OdometryCalibration::correct(const Motion& motion) const {
  Motion corrected = motion;
  corrected.turned_by_gyro = motion.gyro && gyro_.isUsed();
  const double yaw = corrected.turned_by_gyro ? gyro_.turnOf(motion)
                                              : odometry_turn_.correct(motion.turn, motion.delta.x);
  // The chord of an arc turns by half of the yaw.
  const double half = 0.5 * (yaw - motion.delta.yaw);
  const double c = distance_.scale() * std::cos(half);
  const double s = distance_.scale() * std::sin(half);
  corrected.delta = {c * motion.delta.x - s * motion.delta.y,
                     s * motion.delta.x + c * motion.delta.y, wrapAngle(yaw)};
  corrected.distance = distance_.scale() * motion.distance;
  corrected.scale_variance = distance_.varianceAlong(corrected.delta.x);
  return corrected;
}

void OdometryCalibration::learn(const Motion& motion, const PoseCorrection& correction,
                                const MapFit& fit) {
  const Pose2& moved = motion.delta;
  const double true_turn = wrapAngle(moved.yaw + correction.pose.yaw);
  odometry_turn_.learn({motion.turn, moved.x, motion.twist_change.wz}, true_turn,
                       motion.distance + motion.rotation);
  gyro_.learn(motion, true_turn, odometry_turn_.error());
  if (parameters_.calibration_distance == 0.0) return;
  distance_.learn(motion, correction, fit);
  updateDelay(motion, correction.pose);
}

void OdometryCalibration::resume(const OdometryErrors& errors) {
  if (parameters_.calibration_distance == 0.0) return;
  distance_.resume(errors.distance_scale, errors.scale_distance);
  delay_ = bounded(errors.delay, kMaxDelay);
  odometry_turn_.resume(errors.turn);
}

void OdometryCalibration::restart() {
  distance_.restart();
  odometry_turn_.restart();
  gyro_.restart();
}

void OdometryCalibration::forgetDelay() {
  delay_ = delay_information_ = 0.0;
  odometry_turn_.forgetDelay();
  gyro_.forgetDelay();
}

/// Odometry with delay d lacks a motion of d times the change of the speed: least squares with a
/// forgetting factor over the distance.
void OdometryCalibration::updateDelay(const Motion& motion, const Pose2& correction) {
  const double change = motion.twist_change.vx;
  delay_information_ =
      std::exp(-motion.distance / parameters_.calibration_distance) * delay_information_ +
      change * change;
  const double along = bounded(correction.x, kMaxDelay * std::abs(change));
  delay_ = bounded(delay_ + change * along / (kDistanceDelayPrior + delay_information_), kMaxDelay);
}

}  // namespace racecar_mcl
